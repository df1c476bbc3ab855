// SPDX-License-Identifier: GPL-3.0-or-later
// The bare ground as a surface on a raster, from the last returns.
#pragma once

#include "core/block.h"
#include "core/grid.h"
#include "filters/morphology.h"

namespace swath::filters {

/// What the surface is built with.
struct GroundSurfaceOptions {
  double widest = 50.0;    ///< m, across the largest building that is found by its width
  double longest = 180.0;  ///< m, the longest building that is found by its walls
  double steepest = 1.43;  ///< rise / run of the steepest ground
  double noise = 0.03;     ///< m, standard deviation of a height on hard level ground
};

/// Rasters of one size on `lattice` (cells of ground_cell).
struct GroundSurface {
  core::Lattice lattice;
  Raster height;    ///< m, at the cells' centres; NaN where nothing is within reach
  Raster spread;    ///< m, standard deviation of the ground's returns about it; 0 without any
  Raster support;   ///< ground's returns around the cell, by the last planes' kernel
  Raster standing;  ///< 0 to 1: share of the returns around that stand knee-high above the surface
  Raster sunken;    ///< 0 to 1: share of them that lie deep below it
};

constexpr double ground_cell = 1.0;  ///< m

/// From the points that may_be_ground(), for the first `own` points and `around` metres about them (the rasters may hold more, which is not
/// for use). The result at a place depends on the points within surface_reach() and not on their order.
GroundSurface ground_surface(const core::Block& b, size_t own, double around, const GroundSurfaceOptions& o);

/// Cells around a point that its surface depends on.
int surface_reach(const GroundSurfaceOptions& o);

struct RasterSample {
  double height;       ///< in the raster's unit; NaN where one of the four cells around has none
  double east, north;  ///< rise / run
};
/// Bilinear at map coordinates x, y; the lattice must hold one ring of cells around them.
RasterSample sample(const Raster& r, const core::Lattice& l, double x, double y);

}  // namespace swath::filters
