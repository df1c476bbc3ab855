// SPDX-License-Identifier: GPL-3.0-or-later
// Does a trajectory move as an aircraft does? Its heading against its track with one wind, its roll against its turns, its heights against
// its vertical velocity.
#pragma once

#include <cstddef>
#include <optional>

#include "core/records/trajectory_data.h"

namespace swath::trajectory {

/// Heading less the direction through the air: one airspeed and one wind explain the velocities over the ground.
struct HeadingFit {
  double bias = 0.0;                  ///< heading is so much too large, rad
  double sigma = 0.0;                 ///< of that, rad
  double misfit = 0.0;                ///< rms of the velocities, as a share of the airspeed
  double airspeed = 0.0, wind = 0.0;  ///< m/s
};

/// Recorded angle = factor * the angle that the track shows.
struct FactorFit {
  double factor = 0.0, sigma = 0.0;
  size_t samples = 0;
  double correlation = 0.0;
};

struct FlightChecks {
  std::optional<HeadingFit> heading;     ///< none where track or heading go one way alone
  std::optional<FactorFit> roll_turns;   ///< roll against the bank of a coordinated turn; none without turns
  std::optional<FactorFit> pitch_turns;  ///< pitch against the same: near 0 but where the axes are exchanged
  std::optional<FactorFit> climb;        ///< changes of height against the recorded vertical velocity; none without velocities
};

/// Times rise; looks at one record in a second or so.
FlightChecks check_flight(const core::TrajectoryData& data);

}  // namespace swath::trajectory
