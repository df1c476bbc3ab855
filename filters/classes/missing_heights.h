// SPDX-License-Identifier: GPL-3.0-or-later
// Heights above ground beside the edge of a terrain model.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// Metres of points around a place that fill_missing_heights depends on there.
double missing_heights_halo();

/// Gives usable points without a height (NaN) the one above the ground's level at the nearest points that have one, within about 24 m, the
/// lowest of equally near ones: a roof cut by the rim of the data often lies beyond the last triangle of the ground. Returns their rows.
/// Needs column height; does not depend on the order of the points.
std::vector<std::uint32_t> fill_missing_heights(core::Block& b);

}  // namespace swath::filters
