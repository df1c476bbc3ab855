// SPDX-License-Identifier: GPL-3.0-or-later
// The raw returns around a target, line by line, within bounds of memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/target/target_edges.h"
#include "calib/terms.h"
#include "georef/shot_geometry.h"
#include "georef/shot_stream.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct LinePulses {
  int line = 0;
  TargetPulses pulses;
  std::uint32_t kept_one_in = 1;  ///< of the pulses near the target
};

struct CollectedPulses {
  std::vector<LinePulses> lines;           ///< in the order of the stream; lines that pass the target by have no pulses
  double widest = 0.0;                     ///< largest |tangent| of the beams across the flight, scanner frame
  bool several_returns = false;            ///< the scanner records more than one return of a pulse
  std::uint64_t returns = 0, outside = 0;  ///< all returns; those whose time no span of the trajectory holds
};

/// Pulses whose first return lies within `search` m per m of range, and 5 m, of the target's outline. No more than `most` pulses a line:
/// beyond, every second one is dropped as often as needed.
CollectedPulses collect_pulses(const ShotStream& shots, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                               const RoofTarget& target, double search, size_t most = 60000);

}  // namespace swath::calib
