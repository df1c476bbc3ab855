// SPDX-License-Identifier: GPL-3.0-or-later
// Where an edge lies, by the pulses that met what ends there and those that passed it.
#pragma once

#include <vector>

namespace swath::quality {

/// A pulse that came down near an edge.
struct EdgePulse {
  double out = 0.0;   ///< m beyond the edge as surveyed, where the beam crosses its surface
  double wall = 0.0;  ///< m by which a hit reaches farther out, because the top of the wall below counts as the surface
  bool hit = false;
};

constexpr double farthest_edge = 1.2;  ///< m from the surveyed place that an edge is looked for

/// Beyond the surveyed edge; m. `is_shown`: it was looked for far enough, and the pulses leave no other place.
struct EdgePlace {
  double at = 0.0, sigma = 0.0;
  bool is_shown = false;
};

/// Of edges whose beams have one width: each edge has its own pulses.
std::vector<EdgePlace> edge_places(const std::vector<std::vector<EdgePulse>>& edges);

/// The place beyond which fewer hits and more misses would lie than on any other side, to 1 cm.
double rough_edge(const std::vector<EdgePulse>& pulses);

}  // namespace swath::quality
