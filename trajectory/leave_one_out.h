// SPDX-License-Identifier: GPL-3.0-or-later
// How good an interpolator of fixes is: each fix is left out, predicted from the others and compared.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/value.h"
#include "trajectory/kinematic.h"
#include "trajectory/point_smoother.h"

namespace swath::trajectory {

enum class Interpolator { kalman, line, parabola, rts };
constexpr std::array<Interpolator, 4> interpolators{Interpolator::kalman, Interpolator::line, Interpolator::parabola, Interpolator::rts};
/// As tables head their columns: "Kalman", "straight line" ...
std::string_view title_of(Interpolator i);

/// Of differences fix minus interpolated, per axis east, north, height; m. NaN where n is too small.
struct DifferenceStatistics {
  Eigen::Vector3d mean, sigma, rms, max_abs;
  Eigen::Vector3d median_formal;  ///< median of the interpolated position's own sigma
};

struct LeaveOneOut {
  std::vector<size_t> fix;   ///< those left out, one at a time: every one with a full window on both sides
  std::vector<double> time;  ///< theirs, s
  std::array<std::vector<Eigen::Vector3d>, interpolators.size()> difference;  ///< fix minus interpolated, m
  std::array<DifferenceStatistics, interpolators.size()> statistics;
  Eigen::Vector3d acceleration;  ///< of the RTS, (m/s^2)/sqrt(Hz)
  size_t beside_gaps = 0;        ///< fixes not used, since their window is not full (ends and gaps)
  double step = 0.0;             ///< median step between fixes, s

  const DifferenceStatistics& of(Interpolator i) const { return statistics[static_cast<size_t>(i)]; }
  /// Tables in centimetres, as text for a page of 100 columns.
  std::string table() const;
  core::Value value() const;
};

DifferenceStatistics statistics_of(const std::vector<Eigen::Vector3d>& differences, const std::vector<Eigen::Vector3d>& formal);

/// `smoother`: of the same fixes.
LeaveOneOut leave_one_out(const PointFixes& fixes, const PointSmoother& smoother, const KinematicOptions& options);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::Interpolator> {
  static constexpr std::array<std::string_view, 4> names{"kalman", "line", "parabola", "rts"};
};
}  // namespace swath::core
