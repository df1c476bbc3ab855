// SPDX-License-Identifier: GPL-3.0-or-later
// Fixes and IMU records as specific force over the same stretches, the IMU's at a grid of clock offsets.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/records/gnss_data.h"
#include "trajectory/ins/imu_walk.h"

namespace swath::trajectory {

constexpr double clock_spacing = 0.2;  ///< s between the middles of second differences, at least
constexpr double clock_grid = 0.05;    ///< s between offsets: the triangle of 2 s leaves nothing that a cubic over this would miss

/// One second difference: of the fixes, and of the IMU's double integral at each offset of the grid.
struct ClockTriple {
  double time;                          ///< from the window's middle, s
  Eigen::Vector3d force;                ///< by the fixes, inertial axes that are north, east, down at the window's middle, m/s^2
  std::vector<Eigen::Vector3d> sensed;  ///< body axes of the window's beginning, m/s^2
  Eigen::Matrix3d turn;                 ///< of the body since then, at the middle fix
  Eigen::Matrix3d drift;                ///< integral of it from the window's middle to there, s: what a gyro's bias turns
  Eigen::Matrix3d scale;                ///< the same of it times the body's rates: what a gyro's scale factor turns
};

struct ClockWindow {
  std::vector<ClockTriple> triples;
  double speed = 0.0;  ///< m/s
};

/// Stretches of 20 s (longer where fixes are more than 1 s apart) without a gap, the liveliest first, as many as 24 MB hold.
/// `half_span`: s from the middle fix of a second difference to its others.
/// `search`: s, half the grid's length. `step`: of the fixes, s. `offsets`: number of grid points.
std::vector<ClockWindow> clock_windows(const ImuPath& path, const core::GnssData& gnss, const Eigen::Vector3d& lever, double search,
                                       double step, double half_span, size_t offsets);

}  // namespace swath::trajectory
