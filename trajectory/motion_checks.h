// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory held against the mechanics of what carries it: an aircraft banks into its turns, heights change as the vertical velocity
// says.
#pragma once

#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/trajectory_data.h"

namespace swath::trajectory {

struct MotionChecks {
  double turning = 0.0;         ///< s in turns of more than 1 m/s2 across the track
  double roll_per_bank = 0.0;   ///< slope of roll on the bank of a coordinated turn (no side force in the aircraft): 1 in flight
  double pitch_per_bank = 0.0;  ///< the same of pitch: 0 in flight
  double climb_ratio = 0.0;     ///< change of height per metre of climb by the recorded vertical velocity; 0 where none is known
  bool turns_contradict = false, heights_contradict = false;  ///< `warnings` says so
  std::vector<std::string> warnings;
};

/// Takes any data. `min_speed`: slower records have no track. Records are taken in the file's order; steps that jump are left out.
MotionChecks check_motion(const core::TrajectoryData& data, core::MetresPerSecond min_speed);

}  // namespace swath::trajectory
