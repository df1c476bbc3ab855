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

/// Offsets at which the IMU's record is compared: an odd number of them, `clock_grid` apart, about `middle`.
struct ClockGrid {
  double middle = 0.0;  ///< s
  size_t offsets = 0;

  double reach() const { return 0.5 * static_cast<double>(offsets - 1) * clock_grid; }
  double at(size_t i) const { return middle - reach() + static_cast<double>(i) * clock_grid; }
};

/// Gyro bias, accelerometer bias, gyro and accelerometer scale factors, three each.
constexpr int clock_sensor_errors = 12;
using ClockSensorErrors = Eigen::Matrix<double, clock_sensor_errors, 1>;

/// One second difference: of the fixes, and of the IMU's double integral at each offset of the grid.
struct ClockTriple {
  Eigen::Vector3d force;                ///< by the fixes, inertial axes that are north, east, down at the window's middle, m/s^2
  std::vector<Eigen::Vector3d> sensed;  ///< body axes of the window's beginning, m/s^2
  /// Derivatives of `sensed` by the sensors' errors at the grid's middle, averaged like it over the second difference: a slow craft turns
  /// by a radian and more within one. The part of a gyro's bias or scale factor that a constant rotation takes up is taken out.
  Eigen::Matrix<double, 3, clock_sensor_errors> by_sensors;
};

struct ClockWindow {
  std::vector<ClockTriple> triples;
  double speed = 0.0;  ///< m/s
};

/// Stretches of 20 s (longer where fixes are more than 1 s apart) without a gap, the liveliest first, as many as 24 MB hold.
/// `half_span`: s from the middle fix of a second difference to its others. `step`: of the fixes, s. `known`: errors of the sensors that
/// are taken out beforehand.
std::vector<ClockWindow> clock_windows(const ImuPath& path, const core::GnssData& gnss, const Eigen::Vector3d& lever, double step,
                                       double half_span, const ClockGrid& grid, const ClockSensorErrors& known = ClockSensorErrors::Zero());

}  // namespace swath::trajectory
