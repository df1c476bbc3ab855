// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many returns may belong to a wire, by the columns of voxels around them: a cheap test before the search for lines.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/classes/plane_samples.h"

namespace swath::filters {

/// Metres of points around a place that airy_points depends on there.
double airy_points_halo();

/// 1 for each of the points with `candidate` around which at most two thirds of the 7 x 7 columns of voxels hold a candidate or a point of
/// a `surface` on the point's level or the one above or below: wires, also several side by side, take few columns, crowns and roofs fill
/// them. Voxels are as wide as the returns are apart (`where`), so that thin returns fill them too. Does not depend on the order of the
/// points.
std::vector<std::uint8_t> airy_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface, const Districts& where);

}  // namespace swath::filters
