// SPDX-License-Identifier: GPL-3.0-or-later
// A wire between two supports: a catenary in an upright plane, fitted to returns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace swath::terrain {

/// z(s) = z0 + a cosh((s - s0) / a) - a, by its height, slope and curvature at s = `at`: these stay well determined where the wire is
/// nearly straight. kappa = 1 / a.
struct Catenary {
  double at = 0.0;      ///< m along
  double level = 0.0;   ///< z(at), m
  double slope = 0.0;   ///< dz/ds there
  double kappa = 1e-3;  ///< 1 / m; 0: a straight line

  double z(double s) const;
  double dz(double s) const;
  /// Derivatives of z(s) by level, slope and kappa.
  Eigen::Vector3d gradient(double s) const;
  double a() const { return 1.0 / kappa; }
  /// The lowest point, on the curve or on its continuation; kappa not 0.
  double s0() const;
  double z0() const;
  /// Where the curve is steepest along a chord of this slope: the place of the sag under it. kappa not 0.
  double place_of(double chord_slope) const;
};

/// A return of a wire in the wire's plane.
struct OnWire {
  double s = 0.0, z = 0.0;  ///< m
  std::uint16_t line = 0;   ///< flight line
};

/// How the curve of one flight line differs from that of all: by level + tilt (s - at).
struct LineOfFlight {
  std::uint16_t line = 0;
  double share = 0.0;  ///< of the returns; the curve of all is the lines' mean by these
  double level = 0.0;  ///< m
  double tilt = 0.0;
};

struct CatenaryFit {
  Catenary curve;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of level, slope and kappa, of what returns scatter within a flight line
  double sigma_lines = 0.0;                              ///< m, of the level: how flight lines that see the wire agree
  std::vector<LineOfFlight> lines;                       ///< by number
  double sigma = 0.0;                                    ///< of one return in height, m, from the residuals
  size_t used = 0;                                       ///< returns that were not rejected
  bool found = false;
  /// Standard deviation of z(s), m, against what the same flight lines see: the line-to-line part is not in it.
  double sigma_z(double s) const;
};

/// Least squares with returns beyond 3.5 robust sigmas rejected in turn. Where several flight lines see the wire, each but the first has an
/// offset in height of its own, and a tilt where it sees 30 m or more: neither a step between lines nor errors of their roll, nor of their
/// places along the wire, bend the curve. Not found: fewer than five returns, or all at nearly one place.
CatenaryFit fit_catenary(const std::vector<OnWire>& returns);

}  // namespace swath::terrain
