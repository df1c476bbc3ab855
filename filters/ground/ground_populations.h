// SPDX-License-Identifier: GPL-3.0-or-later
// Places where the returns about the ground's surface are two populations: soil, and a low crop that drew the surface up between them.
#pragma once

#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "filters/ground/ground_chance.h"
#include "filters/ground/morphology.h"

namespace swath::filters {

/// The lower of the two populations at each cell of `lattice`.
struct LowerPopulations {
  core::Lattice lattice;
  Raster middle;  ///< m over the surface, below 0; NaN where the returns are one population
  Raster spread;  ///< m, standard deviation
};

/// `returns` has one entry per point of the block. `noise`: m, of heights on hard level ground, misfit of strips included. For the first
/// `own` points and `around` metres about them; the result at a place depends on the returns within ground_populations_reach metres and not
/// on their order.
LowerPopulations lower_populations(const core::Block& b, size_t own, double around, const std::vector<ReturnOverGround>& returns,
                                   double noise);

extern const double ground_populations_reach;  ///< m

}  // namespace swath::filters
