// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of the GNSS antenna at events with their sigma.
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
  Eigen::Vector3d sigma, velocity_sigma;  ///< same axes, m and m/s
  PointState::Matrix6 covariance;         ///< of the error, same axes: position, velocity
};

/// Is this fix of use: time, position and covariance finite, covariance positive definite?
bool usable(const core::GnssData& gnss, size_t fix);

/// The fixes in east, north, up at the first one, cut into pieces, with their motion. `gnss`: three usable fixes or more, time rising.
/// `lines`: in GPS time.
PointTrack track_of(const core::GnssData& gnss, const std::vector<LineSpan>& lines, const KinematicOptions& options);

/// `track`: of fixes whose first is at `origin` (ecef, m). In the order of the times given.
std::vector<EventPosition> positions_at(const PointTrack& track, const Eigen::Vector3d& origin, const std::vector<double>& times,
                                        Interpolator method, const KinematicOptions& options);

}  // namespace swath::trajectory
