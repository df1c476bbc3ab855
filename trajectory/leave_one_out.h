// SPDX-License-Identifier: GPL-3.0-or-later
// How good an interpolator of fixes is: each fix is left out, predicted from the others and compared.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "trajectory/interpolators.h"

namespace swath::trajectory {

/// Of differences fix minus interpolated, per axis east, north, height; m. NaN where n is too small.
struct DifferenceStatistics {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), sigma = mean, rms = mean, max_abs = mean;
  Eigen::Vector3d median_formal = mean;    ///< median of the sigma that the interpolator itself states
  Eigen::Vector3d median_expected = mean;  ///< median sigma of the difference by the motion model and the fix's white error
  Eigen::Vector3d ratio = mean;            ///< rms of difference / that sigma: 1 where it is true
};

template <class V>
void describe(const DifferenceStatistics& r, V& v) {
  using core::metres;
  v.result("sigma_m", r.sigma, metres(4), "Standard deviation of fix less interpolated: east, north, height.");
  v.result("mean_m", r.mean, metres(4), "Mean difference.");
  v.result("rms_m", r.rms, metres(4), "RMS difference.");
  v.result("largest_m", r.max_abs, metres(4), "Largest difference.");
  v.result("median_expected_sigma_m", r.median_expected, metres(4), "Median sigma of the difference by the motion model.");
  v.result("difference_over_sigma", r.ratio, core::plain(2), "RMS of difference over that sigma; 1: the sigma is true.");
  v.result("median_filter_sigma_m", r.median_formal, metres(4), "Median of the sigma that the interpolator itself states.");
}

/// One difference with its sigmas.
struct Difference {
  Eigen::Vector3d value, formal, expected;  ///< m; `expected` of the difference
};
DifferenceStatistics statistics_of(const std::vector<Difference>& differences);

/// Statistics of each interpolator.
using MethodStatistics = std::array<DifferenceStatistics, interpolators.size()>;

/// The test on one piece of the flight.
struct PieceTest {
  std::string name;
  size_t fixes = 0;  ///< left out, one at a time
  MethodStatistics statistics;
};

template <class V>
void describe_methods(const MethodStatistics& s, V& v) {
  v.table("kalman", s[0], "Kalman filter from both sides.");
  v.table("straight_line", s[1], "Straight line between the neighbours.");
  v.table("parabola", s[2], "Polynomial of 2nd degree.");
  v.table("rts", s[3], "Smoother over the whole pass.");
}
template <class V>
void describe(const PieceTest& r, V& v) {
  v.result("name", r.name, "Flight line, straight piece with its course, turns, or standing.");
  v.result("fixes", r.fixes, "Fixes of it that were left out, one at a time.");
  describe_methods(r.statistics, v);
}

struct LeaveOneOut {
  std::vector<size_t> fix;   ///< those left out, one at a time: every one with a full window on both sides
  std::vector<double> time;  ///< theirs, s
  std::array<std::vector<Difference>, interpolators.size()> difference;
  MethodStatistics statistics;
  std::vector<PieceTest> pieces;
  size_t beside_gaps = 0;  ///< fixes not used, since their window is not full (ends and gaps)
  double step = 0.0;       ///< median step between fixes, s

  const DifferenceStatistics& of(Interpolator i) const { return statistics[static_cast<size_t>(i)]; }
  /// Tables in centimetres, as text for a page of 140 columns.
  std::string table() const;
};

template <class V>
void describe(const LeaveOneOut& r, V& v) {
  v.result("fixes", r.fix.size(), "Fixes that were left out, one at a time.");
  v.result("without_full_window", r.beside_gaps, "Fixes near a gap or an end of the record, not used.");
  v.result("step_s", r.step, core::seconds().always(), "Median step between fixes.");
  describe_methods(r.statistics, v);
  v.tables("pieces", r.pieces, "The same by flight line, or by straight piece; turns and standing apart.");
}

LeaveOneOut leave_one_out(const PointTrack& track, const KinematicOptions& options);

/// "0.05 0.04 0.05", for tables.
std::string row_of(const Eigen::Vector3d& v, double factor, int decimals);

}  // namespace swath::trajectory
