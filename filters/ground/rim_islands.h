// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of the ground at the rim of the data that nothing links to the ground around them and that are above it: parts of buildings
// whose walls lie beyond the rim.
#pragma once

#include "filters/ground/morphology.h"

namespace swath::filters {

/// 1 in the outermost cells with a return, 0 in the others, NaN where none is; a void narrower than 12 cells is no outside. `lowest`: the
/// lowest returns in cells of 1 m before anything is taken off. Beyond the raster nothing is known.
Raster rim_cells(const Raster& lowest);

/// Voids in `ground` (NaN where no return is and where an object was taken off) the islands at the rim: pieces up to `rim_island_across`
/// cells across, with a step or something other than ground between them and the ground around, that are well above a plane through that
/// ground, in terms of its own residuals. Banks and hills are linked to the ground below and stay. `rim`: rim_cells() of the same cells.
void remove_rim_islands(Raster& ground, const Raster& rim);

constexpr int rim_island_across = 25;  ///< cells
extern const int rim_island_support;   ///< cells of `ground` around a cell that decide on it
extern const int rim_support;          ///< the same of the lowest returns for rim_cells()

}  // namespace swath::filters
