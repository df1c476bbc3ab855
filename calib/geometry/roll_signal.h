// SPDX-License-Identifier: GPL-3.0-or-later
// The aircraft's roll as the laser sees it: the tilt of the ground across the swath, against the roll of the trajectory.
#pragma once

#include <optional>
#include <vector>

#include "calib/geometry/geometry_sample.h"
#include "calib/terms.h"
#include "core/records/trajectory_data.h"
#include "georef/shot_geometry.h"

namespace swath::calib {

struct RollSignal {
  double factor = 0.0, sigma = 0.0;  ///< tilt of the ground = factor * roll at the same time; 1 where all is right
  double correlation = 0.0;          ///< at the same time
  double offset = 0.0;               ///< s to be added to the laser's times for the best correlation
  double best = 0.0;                 ///< correlation at that offset
  size_t bins = 0;
};

/// Tenths of a second of the profiles, motions slower than a few seconds taken out: slopes of the terrain are slow, roll is not. None where
/// the scanner does not see across, or the aircraft hardly rolls. `search`: largest offset, s; 0: none is sought.
std::optional<RollSignal> roll_signal(const std::vector<PassSample>& profiles, const ShotGeometry& geometry,
                                      const core::TrajectoryData& trajectory, double search);

}  // namespace swath::calib
