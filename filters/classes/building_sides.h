// SPDX-License-Identifier: GPL-3.0-or-later
// What belongs to a building beside the planes of its roof: the rest of the roof's rim, and its walls.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// Metres of points around a place that building_sides depends on there.
double building_sides_halo();

/// 1 for those of the first `own` points that are last returns with `candidate` and lie within `tolerance` (m) of the plane through the
/// returns of `roof` around them, at least six within 3 m; and for those within 1 m in plan of a return of `roof` that is higher: walls lie
/// under the eaves. Those lower above ground than `lowest_roof` (m) must lie within 0.7 m of a roof that is half a metre higher than that.
/// Needs column height; does not depend on the order of the points.
std::vector<std::uint8_t> building_sides(const core::Block& b, const std::vector<std::uint8_t>& roof,
                                         const std::vector<std::uint8_t>& candidate, double tolerance, double lowest_roof, size_t own);

}  // namespace swath::filters
