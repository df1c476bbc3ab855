// SPDX-License-Identifier: GPL-3.0-or-later
// Small groups of points that stand alone in space.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

struct LonePoint {
  std::uint32_t row = 0;
  bool above = false;  ///< of everything around; else below
};

/// Metres of points around a tile that lone_points depends on.
double lone_points_halo(double gap);

/// The points of groups of at most `most`, in lattice cubes of side `gap` (m) that touch one another and no other occupied cube, over at
/// most two cubes in east and in north; so more than `gap` of empty space lies around a group. All other points of the cubes' columns and
/// of the columns next to them must lie below the group, or all above it, and there must be some. Ascending by row. Among the points
/// with `takes_part`; the result depends on the points within lone_points_halo() and not on their order.
std::vector<LonePoint> lone_points(const core::Block& b, const std::vector<std::uint8_t>& takes_part, double gap, int most);

}  // namespace swath::filters
