// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/trajectory_data.h"
#include "trajectory/ins/ins_smoother.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// The smoothed trajectory at the IMU's instants: from each node the mechanisation runs on with the smoothed state; what it misses the
/// next node by is spread over the interval (attitude and velocity linear, position by the cubic that has no closing error and whose slope
/// ends at the velocity's), so that nothing jumps. Bridged stretches of the IMU get no records. At most `rate` records per second.
/// Sigmas and covariances are linear in time between nodes.
core::TrajectoryData trajectory_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, double rate);

/// The same without sigmas, of the intervals between nodes that are `wanted` (one entry per interval): poses for a linearisation.
PoseRecords poses_of(const Problem& problem, const std::vector<Estimate>& estimates, double rate, const std::vector<char>& wanted);

}  // namespace swath::trajectory
