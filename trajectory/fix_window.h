// SPDX-License-Identifier: GPL-3.0-or-later
// Fixes of one antenna in a local frame, the fixes around an instant, and the polynomial through them.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <utility>
#include <vector>

#include "core/records/gnss_data.h"

namespace swath::trajectory {

/// Positions with covariance in one Cartesian frame, axes east, north, up. Columns of one length, time rising.
struct PointFixes {
  std::vector<double> time;                 ///< s
  std::vector<Eigen::Vector3d> position;    ///< m
  std::vector<Eigen::Matrix3d> covariance;  ///< m^2, positive definite

  size_t size() const { return time.size(); }
};

/// East, north, up at one place: p_local = local_R_ecef (p_ecef - origin).
struct LocalFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();            ///< ecef, m
  Eigen::Matrix3d local_R_ecef = Eigen::Matrix3d::Identity();  ///< rows: east, north, up

  Eigen::Vector3d to_ecef(const Eigen::Vector3d& local) const { return origin + local_R_ecef.transpose() * local; }
};
LocalFrame local_frame(const Eigen::Vector3d& ecef);
PointFixes to_local(const core::GnssData& gnss, const LocalFrame& frame);

/// Where an instant lies among the fixes.
enum class Reach {
  full,     ///< the whole window on both sides
  partial,  ///< fewer fixes on a side: the record's end or a gap is near
  too_few,  ///< fewer than two fixes on a side
  gap,      ///< between two fixes that are too far apart
  outside,  ///< before the first or after the last fix
};
/// Can an instant be interpolated?
inline bool reached(Reach r) { return r == Reach::full || r == Reach::partial; }

/// Fixes [before, middle) precede an instant, [after, end) follow it. No step within it is a gap.
struct FixWindow {
  size_t before = 0, middle = 0, after = 0, end = 0;
  Reach reach = Reach::outside;

  size_t size() const { return (middle - before) + (end - after); }
  size_t last() const { return end - 1; }
  /// The k-th fix of the window.
  size_t at(size_t k) const { return k < middle - before ? before + k : after + (k - (middle - before)); }
};

/// Up to `epochs` fixes on each side of t; a fix at t itself counts as before it. A step longer than `longest_step` is a gap.
FixWindow window_at(const std::vector<double>& time, double t, size_t epochs, double longest_step);
/// The same around fix `left_out`, without it. Full, or else not usable (partial at best) near ends and gaps.
FixWindow window_without(const std::vector<double>& time, size_t left_out, size_t epochs, double longest_step);

/// Position as a polynomial of time, its coefficients with their covariance.
struct PolynomialFit {
  double start = 0.0;                                     ///< time of the window's first fix: s = t - start
  Eigen::Matrix<double, 3, Eigen::Dynamic> coefficients;  ///< of 1, s, s^2 ...: m, m/s, m/s^2
  Eigen::MatrixXd covariance;                             ///< a-priori; order: the three of 1, the three of s ...
  Eigen::Vector3d variance_factor;                        ///< of each axis (simultaneous: the same for all); 1 where nothing is left over

  Eigen::Vector3d position(double t) const;
  Eigen::Vector3d velocity(double t) const;
  /// Covariance of position and velocity at t.
  Eigen::Matrix<double, 6, 6> covariance_at(double t) const;
};

/// Least squares over the window's fixes. `axis_by_axis`: covariances between axes are left out, so that each axis stands alone; `weighted`
/// false: the coefficients come from unit weights. Needs more than `degree` fixes.
PolynomialFit fit_polynomial(const PointFixes& fixes, const FixWindow& window, int degree, bool axis_by_axis, bool weighted);

}  // namespace swath::trajectory
