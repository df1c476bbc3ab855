// SPDX-License-Identifier: GPL-3.0-or-later
// How good an interpolator of fixes is: each fix is left out, predicted from the others and compared.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/result.h"
#include "trajectory/kinematic.h"
#include "trajectory/point_smoother.h"

namespace swath::trajectory {

enum class Interpolator { kalman, line, parabola, rts };
constexpr std::array<Interpolator, 4> interpolators{Interpolator::kalman, Interpolator::line, Interpolator::parabola, Interpolator::rts};
/// As tables head their columns: "Kalman", "straight line" ...
std::string_view title_of(Interpolator i);

/// Of differences fix minus interpolated, per axis east, north, height; m. NaN where n is too small.
struct DifferenceStatistics {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), sigma = mean, rms = mean, max_abs = mean;
  Eigen::Vector3d median_formal = mean;  ///< median of the interpolated position's own sigma
};

/// Of one interpolator; the acceleration only where it has one.
struct InterpolatorTest {
  DifferenceStatistics statistics{};
  std::optional<Eigen::Vector3d> acceleration{};
};

template <class V>
void describe(const InterpolatorTest& r, V& v) {
  using core::metres;
  v.result("sigma_m", r.statistics.sigma, metres(4), "Standard deviation of fix less interpolated: east, north, height.");
  v.result("mean_m", r.statistics.mean, metres(4), "Mean difference.");
  v.result("rms_m", r.statistics.rms, metres(4), "RMS difference.");
  v.result("largest_m", r.statistics.max_abs, metres(4), "Largest difference.");
  v.result("median_formal_sigma_m", r.statistics.median_formal, metres(4), "Median of the interpolated position's own sigma.");
  v.result("acceleration_m_s2_per_sqrt_hz", r.acceleration, core::Form{"m/s2/sqrt(Hz)"}, "Acceleration noise that the smoother found.");
}

struct LeaveOneOut {
  std::vector<size_t> fix;   ///< those left out, one at a time: every one with a full window on both sides
  std::vector<double> time;  ///< theirs, s
  std::array<std::vector<Eigen::Vector3d>, interpolators.size()> difference;  ///< fix minus interpolated, m
  std::array<DifferenceStatistics, interpolators.size()> statistics;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of the RTS, (m/s^2)/sqrt(Hz)
  size_t beside_gaps = 0;                                  ///< fixes not used, since their window is not full (ends and gaps)
  double step = 0.0;                                       ///< median step between fixes, s

  const DifferenceStatistics& of(Interpolator i) const { return statistics[static_cast<size_t>(i)]; }
  /// Tables in centimetres, as text for a page of 100 columns.
  std::string table() const;
};

template <class V>
void describe(const LeaveOneOut& r, V& v) {
  v.result("fixes", r.fix.size(), "Fixes that were left out, one at a time.");
  v.result("without_full_window", r.beside_gaps, "Fixes near a gap or an end of the record, not used.");
  v.result("step_s", r.step, core::seconds().always(), "Median step between fixes.");
  v.table("kalman", InterpolatorTest{r.of(Interpolator::kalman)}, "Kalman filter from both sides.");
  v.table("straight_line", InterpolatorTest{r.of(Interpolator::line)}, "Straight line between the neighbours.");
  v.table("parabola", InterpolatorTest{r.of(Interpolator::parabola)}, "Polynomial of 2nd degree.");
  v.table("rts", InterpolatorTest{r.of(Interpolator::rts), r.acceleration}, "Smoother over the whole pass.");
}

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
