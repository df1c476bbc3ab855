// SPDX-License-Identifier: GPL-3.0-or-later
// Wires: returns in line over a long stretch, high up, with empty space around the line.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/classes/plane_samples.h"

namespace swath::filters {

/// Metres of points around a place that wire_points depends on there.
double wire_points_halo();

/// 1 for each of the first `own` points with `candidate` that lies on a wire: in line with at least four other candidates over at least 15
/// m, straight in plan and no steeper than 30 degrees, in height along a parabola that may open upwards as a catenary does, each within 0.4
/// m, with gaps of at most 7 m (16 m with at least six others), while nearly nothing else lies within 1.5 m of that line, points of a
/// `surface` least of all. Wires side by side differ from foliage by the few places of the line's cross-section that they take. Then the
/// candidates that carry on such lines by up to one gap: 2. The 1 hold for points within 15 m of the own ones, too. Does not depend on the
/// order of the points.
std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface, const Districts& where, size_t own);

}  // namespace swath::filters
