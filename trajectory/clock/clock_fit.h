// SPDX-License-Identifier: GPL-3.0-or-later
// The offset of an IMU's clock near a known one, with its sigma, from windows of specific force.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/records/imu_spec.h"
#include "trajectory/clock/clock_windows.h"

namespace swath::trajectory {

struct ClockFit {
  bool motion_changes = false;                            ///< false: nothing in the windows depends on the offset, and the rest is not set
  double shift = 0.0;                                     ///< offset from the grid's middle, s
  double sigma = 0.0;                                     ///< its, s
  Eigen::Vector3d rms{0, 0, 0};                           ///< of what is left, north east down, m/s^2
  ClockSensorErrors sensors = ClockSensorErrors::Zero();  ///< medians of the windows' own: signs as they must be taken out of the records
};

/// Least squares by Gauss and Newton with Huber's weights. The offset is common to all windows; each has a rotation, and errors of the
/// sensors, of its own. The variance is the larger of two: the scatter of the windows' own answers; and what the residuals' noise does,
/// with its correlation from one second difference to the next, together with an attitude that wanders by the gyros' random walk. The
/// lever arm's is added. `spacing`: s between second differences.
ClockFit fit_clock(const std::vector<ClockWindow>& windows, const ClockGrid& grid, const core::ImuErrorModel& spec, double lever_sigma,
                   double spacing);

/// The rotation from the body's axes at the window's beginning to the fixes' (Wahba). `sensed`: one per second difference.
Eigen::Matrix3d body_rotation(const ClockWindow& window, const std::vector<Eigen::Vector3d>& sensed);

}  // namespace swath::trajectory
