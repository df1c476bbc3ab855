// SPDX-License-Identifier: GPL-3.0-or-later
// Wires: points in line, high up, with empty space around the line.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// Metres of points around a place that wire_points depends on there.
double wire_points_halo();

/// 1 for each of the points with `candidate` that lies on a straight, not steep line with at least four other candidates over at least
/// 5 m, within 0.5 m of it, while nearly nothing else lies within 1.5 m of that line; judged within 6 m of the point. At least
/// three of those around must be in line themselves; where they are, fewer points suffice, as at a wire's end. Does not depend on the order
/// of the points.
std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate);

}  // namespace swath::filters
