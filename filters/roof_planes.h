// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth opaque planes among the points off the ground: roofs and decks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// Metres of points around a place that planar_points depends on there.
double planar_points_halo();

/// 1 for each of the points with `candidate` that lies on a plane of the window of 6 m around it (windows overlap by half): within
/// `tolerance` (m) of it, with the window's other returns of the plane's ground plan mostly on it too and mostly last returns: what a beam
/// goes through is no roof. Planes steeper than 60 deg are not looked for. Does not depend on the order of the points.
std::vector<std::uint8_t> planar_points(const core::Block& b, const std::vector<std::uint8_t>& candidate, double tolerance);

}  // namespace swath::filters
