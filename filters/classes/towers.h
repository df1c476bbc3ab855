// SPDX-License-Identifier: GPL-3.0-or-later
// Supports of wires: narrow upright things that reach up to them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// Metres of points around a place that tower_points depends on there.
double tower_points_halo();

/// 1 for each of the first `own` points with `tall` that belongs to a support, 2 for those of wires beside it. `wire` as wire_points gives
/// it; `tall`: points off the ground and on no surface, or wire with 1. A support is a column 3 m wide with at least three returns over at
/// least 3 m of height without a gap of 5 m that ends 3 m below the lowest wire within 6 m, or higher (of a pole, 0.7 m around its axis:
/// over 5 m without a gap of 10 m, that to the wire neither), while around it, up to 4.5 m away and from 5 m below its top (or the wires)
/// on, at most 20 % of the cells of 1 m hold returns other than those in line with wires, or all but 5 % in one row 2 m wide through it:
/// arms, but not a crown. Its returns are those of the column as near to its axis as the upper 8 m are wide; arms are those around it from
/// 3 m below the wires on. What is 8 m above the highest wire is something else. Does not depend on the order of the points.
std::vector<std::uint8_t> tower_points(const core::Block& b, const std::vector<std::uint8_t>& wire, const std::vector<std::uint8_t>& tall,
                                       size_t own);

}  // namespace swath::filters
