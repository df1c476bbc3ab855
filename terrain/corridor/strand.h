// SPDX-License-Identifier: GPL-3.0-or-later
// The returns of one conductor, or one bundle, between two supports, with their curve.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "terrain/corridor/catenary.h"

namespace swath::terrain {

/// A return of class 14. Map frame minus an origin, m.
struct WirePoint {
  double x = 0.0, y = 0.0, z = 0.0;
  std::uint16_t line = 0;  ///< flight line
};

/// A vertical line on the map as a straight line: s metres along it, v to its left.
struct PlanLine {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), along = Eigen::Vector2d::UnitX();  ///< along: unit vector
  double s(const Eigen::Vector2d& p) const { return along.dot(p - from); }
  double v(const Eigen::Vector2d& p) const { return along.x() * (p - from).y() - along.y() * (p - from).x(); }
  Eigen::Vector2d at(double s, double v = 0.0) const { return from + s * along + v * Eigen::Vector2d(-along.y(), along.x()); }
};

struct Strand {
  PlanLine line;
  double first = 0.0, last = 0.0;                ///< s of the outermost returns
  CatenaryFit fit;                               ///< over s of `line`
  double sigma_v = 0.0;                          ///< of one return across, m
  double sigma_at_mean = 0.0, sigma_turn = 0.0;  ///< of the line in plan: across at s = 0 (m), of its direction (rad)
  std::vector<std::uint32_t> points;
  double length() const { return last - first; }
  Eigen::Vector3d at(double s) const {
    const Eigen::Vector2d p = line.at(s);
    return {p.x(), p.y(), fit.curve.z(s)};
  }
  /// Variance of the line in plan at s, m2, across it.
  double variance_across(double s) const { return sigma_at_mean * sigma_at_mean + s * s * sigma_turn * sigma_turn; }
};

/// First and last s on a's line of b's outermost returns.
struct Range {
  double low, high;
};
Range range_along(const Strand& a, const Strand& b);

/// Fits line and catenary to some of the points; fit.found is false where it cannot.
Strand fit_strand(const std::vector<WirePoint>& points, std::vector<std::uint32_t> rows);

/// Both as one strand; nothing where no curve fits them or more than 5 % of their returns lie off it.
std::optional<Strand> fit_as_one(const std::vector<WirePoint>& points, const Strand& a, const Strand& b);

}  // namespace swath::terrain
