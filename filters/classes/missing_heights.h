// SPDX-License-Identifier: GPL-3.0-or-later
// Heights above ground beside the edge of a terrain model.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/bins.h"

namespace swath::filters {

/// Metres of points around a place that heights filled from beside it depend on there, and those carried across a void.
double missing_heights_halo();
double across_voids_halo();

/// Rows that had no height and are usable.
struct MissingHeights {
  std::vector<std::uint32_t> all, across;  ///< across: filled across a void
};

/// Gives usable points without a height (NaN) the one above the ground's level at the nearest points that have one, within about 24 m, the
/// lowest of equally near ones: a roof cut by the rim of the data often lies beyond the last triangle of the ground. Farther from all
/// these, those within `across` take it from a line between levels on both sides, up to 100 m from each and not steeper than 15 %, the
/// shortest of four, where they lie 2 m above it: wide halls leave voids in the terrain model, and water in voids has no height.
/// Needs column height; does not depend on the order of the points.
MissingHeights fill_missing_heights(core::Block& b, const OwnBox& across);

}  // namespace swath::filters
