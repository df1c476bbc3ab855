// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth opaque planes among the points off the ground: roofs and decks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/classes/plane_samples.h"

namespace swath::filters {

enum class Planar : std::uint8_t {
  none,
  some,  ///< on a plane of the window around
  wide,  ///< on one that goes on over the area wanted
};

/// Metres of points around a place that planar_points depends on there.
double planar_points_halo();

/// For each of the points with `candidate`: does it lie on a plane, within `tolerance` (m), in a third at least of the windows of 3 x 3
/// sample cells around it? The other returns over the plane's ground plan must mostly lie on it too, and those on it must mostly be last
/// returns: what a beam goes through is no roof, unless nearly all first returns lie on it, within a third of the tolerance: glass. Wide is
/// a plane that the windows around continue, within `tolerance` and 11 deg, over `area` (m2, at most 9 x 9 cells count), with most of the
/// returns within half the tolerance: crowns are smooth over a few square metres only. Planes steeper than 60 deg are not looked for.
/// Does not depend on the order of the points.
std::vector<Planar> planar_points(const core::Block& b, const std::vector<std::uint8_t>& candidate, const Districts& where,
                                  double tolerance, double area);

}  // namespace swath::filters
