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
constexpr double wires_beyond = 16.0;  ///< m
constexpr std::uint8_t wire_carried_on = 2, wire_at_support = 3;

/// 1 for each of the first `own` points with `candidate` that lies on a wire: in line with at least four other candidates over at least 15
/// m, straight in plan and no steeper than 30 degrees, in height along a parabola that may open upwards as a catenary does, each within 0.4
/// m, with gaps of at most 7 m (16 m with at least six others), while nearly nothing else lies within 1.5 m of that line, points of a
/// `surface` least of all. Wires side by side differ from foliage by the few places of the line's cross-section that they take. Then the
/// candidates that carry on such lines by up to one gap: 2; and those on such a line up to 12 m on among other things, as at a support
/// whose returns surround the wire: 3, which are wires only where there is one. Holds for points within wires_beyond of the own ones, too.
/// Does not depend on the order of the points.
std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface, const Districts& where, size_t own);

}  // namespace swath::filters
