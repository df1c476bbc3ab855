// SPDX-License-Identifier: GPL-3.0-or-later
// Impossible records of a trajectory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/records/trajectory_data.h"
#include "core/report.h"

namespace swath::io {

constexpr const char* impossible_times = "trajectory records with an impossible time, left out";

/// What is wrong with a record of a trajectory.
enum class PoseFault : std::uint8_t { none, not_finite, impossible, time, place, attitude };

/// Judges each record: values that are not finite; latitudes beyond a pole, heights, speeds and angles that nothing has; a time, place or
/// attitude that contradicts those around it: over an hour, 500 m/s and 100 m, or 3 rad/s and half a radian apart.
std::vector<PoseFault> pose_faults(const core::TrajectoryData& t);

/// Takes the marked elements out.
template <class T>
void leave_out(std::vector<T>& column, const std::vector<std::uint8_t>& marked) {
  size_t kept = 0;
  for (size_t i = 0; i < column.size(); ++i)
    if (!marked[i]) column[kept++] = column[i];
  column.resize(kept);
}

/// Takes the marked records out.
void leave_out(core::TrajectoryData& t, const std::vector<std::uint8_t>& marked);

/// Takes out the records with a fault, counted with what they say, and gives their marks (empty: none). A time of NaN was counted by who
/// read it. Throws Error where too many are not finite or impossible; where too many contradict one another none is taken for the wrong
/// one, and all stay.
std::vector<std::uint8_t> leave_out_faults(core::TrajectoryData& t, const std::string& name, core::Tally& tally);

}  // namespace swath::io
