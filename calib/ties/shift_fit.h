// SPDX-License-Identifier: GPL-3.0-or-later
// Boresight from displacements between lines, with errors of the lines' trajectories beside it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace swath::calib {

/// How far one line lies beside another at one place.
struct ObservedShift {
  int line_a = 0, line_b = 0;            ///< ids
  std::uint64_t look_a = 0, look_b = 0;  ///< of n looks at one square only n - 1 displacements are independent
  std::uint64_t square = 0;              ///< the place
  Eigen::Matrix3d by_a = Eigen::Matrix3d::Zero(), by_b = Eigen::Matrix3d::Zero();  ///< east, north, up by roll, pitch, heading, m/rad
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();                                 ///< of b against a, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();                        ///< m^2
  bool relief = false;                                                             ///< false: the height alone counts
  double weight = 1.0;                                                             ///< robust, 0 to 1: filled in
};

/// Errors of a line's trajectory, each constant along it: sigmas.
struct LineErrors {
  double horizontal = 0.1, height = 0.2;  ///< m
  double attitude = 0.0;                  ///< rad
};

struct ShiftFit3 {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();       ///< of roll, pitch, heading as used, rad: to be subtracted; 0 where not determined
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< 0 for those not determined
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();       ///< of all; infinite where there is nothing to determine it
  std::array<bool, 3> determined{};
  double rms = 0.0;  ///< of horizontal residuals, weighted, m
};

/// shift = (by_b - by_a) error + errors of both lines, by robust least squares (Tukey's weights). An angle whose sigma exceeds
/// `undetermined` is held, the worst first; what its error (of that sigma, `largest` at most) would do to the others is in their
/// covariance. Heights determine roll alone: with fewer than four shifts of relief pitch and heading are held.
ShiftFit3 fit_shifts(std::vector<ObservedShift>& shifts, const LineErrors& lines, double undetermined, double largest);

}  // namespace swath::calib
