// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of the GNSS antenna at events, with the sigma that theory states and the one that the fixes themselves show.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/records/gnss_data.h"
#include "trajectory/leave_one_out.h"

namespace swath::trajectory {

/// The antenna at one event. All NaN where the event was not reached.
struct EventPosition {
  Reach reach = Reach::outside;
  size_t fixes = 0;                       ///< of the window
  Eigen::Vector3d position;               ///< ecef, m
  Eigen::Vector3d velocity;               ///< east, north, up at the position, m/s
  Eigen::Vector3d sigma, velocity_sigma;  ///< formal, same axes, m and m/s
  PointState::Matrix6 covariance;         ///< formal, same axes: position, velocity
};

struct EventPositions {
  std::vector<EventPosition> events;  ///< in the order of the times given
  LeaveOneOut test;
  Eigen::Vector3d empirical;  ///< rms of the leave-one-out differences of the method used, east, north, up, m; NaN without any
  size_t gaps = 0;            ///< steps between fixes that are too long
  double longest_step = 0.0;  ///< s
};

/// Is this fix of use: time, position and covariance finite, covariance positive definite?
bool usable(const core::GnssData& gnss, size_t fix);

/// `gnss`: three usable fixes or more, time rising. Works in east, north, up at the first fix.
EventPositions positions_at(const core::GnssData& gnss, const std::vector<double>& times, Interpolator method,
                            const KinematicOptions& options);

}  // namespace swath::trajectory
