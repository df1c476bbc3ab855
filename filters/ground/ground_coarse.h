// SPDX-License-Identifier: GPL-3.0-or-later
// The bare ground by cells, from the lowest return of each: objects are taken off and holes filled.
#pragma once

#include <vector>

#include "core/grid.h"
#include "filters/ground/morphology.h"

namespace swath::filters {

/// What the ground's surface is built with.
struct GroundSurfaceOptions {
  double widest = 50.0;    ///< m, across the largest building that is found by its width
  double longest = 180.0;  ///< m, the longest building that is found by its walls
  double steepest = 1.43;  ///< rise / run of the steepest ground
  double noise = 0.03;     ///< m, standard deviation of a height on hard level ground
};

constexpr double ground_cell = 1.0;  ///< m

/// A surface wider than the widest building, most of whose border is walls, that stays in the ground. Map coordinates, m.
struct RaisedSurface {
  double x, y;           ///< a place on it, next to the middle
  double east, north;    ///< the middle
  double length, width;  ///< m
  double rise;           ///< m, mean over its walls
};

/// Heights at the cells of `part`, which lies within `all`. `lowest`: the lowest return of each cell of `all`, m; NaN where none is. The
/// result depends on the returns within coarse_ground_reach() cells; `all` must go on for coarse_ground_rim() cells beyond its outermost
/// return, or for that reach around `part`. `raised` gets those surfaces whose place lies in `part`.
Raster coarse_ground(Raster lowest, const core::Lattice& all, const core::Lattice& part, const GroundSurfaceOptions& o,
                     std::vector<RaisedSurface>* raised = nullptr);

int coarse_ground_reach(const GroundSurfaceOptions& o);
int coarse_ground_rim(const GroundSurfaceOptions& o);

/// `l` grown by `cells` to all sides, as far as `within` holds them.
core::Lattice grown(const core::Lattice& l, int cells, const core::Lattice& within);

}  // namespace swath::filters
