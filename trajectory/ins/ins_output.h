// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/records/trajectory_data.h"
#include "trajectory/ins/ins_smoother.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// The smoothed trajectory at the IMU's instants: from each node the mechanisation runs on with the smoothed state; what it misses the
/// next node by is spread over the interval (attitude and velocity linear, position by the cubic that has no closing error and whose slope
/// ends at the velocity's), so that nothing jumps. Bridged stretches of the IMU get no records. About `rate` records per second.
/// Sigmas and covariances are linear in time between nodes.
core::TrajectoryData trajectory_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, double rate);

/// Which of the IMU's records make an output of about `rate` (Hz): every so many, counted from the flight's first.
class OutputRecords {
 public:
  OutputRecords(const Problem& problem, double rate);
  /// Records before an interval; not counted where all are taken.
  std::uint64_t before(size_t interval) const { return before_.empty() ? 0 : before_[interval]; }
  bool takes(std::uint64_t record) const { return record % every_ == 0; }

 private:
  std::uint64_t every_ = 1;
  std::vector<std::uint64_t> before_;
};

/// The same trajectory without sigmas, in the intervals between nodes that are `wanted` (one entry per interval): poses for a
/// linearisation.
PoseRecords poses_of(const Problem& problem, const std::vector<Estimate>& estimates, const OutputRecords& records,
                     const std::vector<char>& wanted);

}  // namespace swath::trajectory
