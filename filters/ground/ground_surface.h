// SPDX-License-Identifier: GPL-3.0-or-later
// The bare ground as a surface on a raster, from the last returns.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "filters/ground/ground_coarse.h"
#include "filters/ground/morphology.h"

namespace swath::filters {

/// Rasters of one size on `lattice` (cells of ground_cell).
struct GroundSurface {
  core::Lattice lattice;
  Raster height;    ///< m, at the cells' centres; NaN where nothing is within reach
  Raster spread;    ///< m, standard deviation of the ground's returns about it; 0 without any
  Raster support;   ///< ground's returns around the cell, by the last planes' kernel
  Raster standing;  ///< 0 to 1: share of the returns around that stand knee-high above the surface
  Raster sunken;    ///< 0 to 1: share of them that lie deep below it
};

/// What the surface starts from.
struct GroundBase {
  core::Lattice lattice;
  Raster height;                    ///< m, by cells (ground_coarse.h)
  std::vector<std::uint32_t> rows;  ///< own points, and others within the lattice that may_be_ground(); ascending
  std::vector<RaisedSurface> raised;
};
/// For the first `own` points and `around` metres about them; empty where own is 0.
GroundBase ground_base(const core::Block& b, size_t own, double around, const GroundSurfaceOptions& o);
/// `near` holds the points of base.rows at least.
GroundSurface ground_surface(const core::Block& near, GroundBase base, const GroundSurfaceOptions& o);

/// From the points that may_be_ground(), for the first `own` points and `around` metres about them (the rasters may hold more, which is not
/// for use). The result at a place depends on the points within surface_reach() and not on their order.
GroundSurface ground_surface(const core::Block& b, size_t own, double around, const GroundSurfaceOptions& o);

/// Cells around a point within which its surface depends on every return, with the rims of rasters; farther off on the lowest of each cell.
int fine_surface_reach();

/// Cells around a point that its surface depends on.
int surface_reach(const GroundSurfaceOptions& o);

struct RasterSample {
  double height;       ///< in the raster's unit; NaN where one of the four cells around has none
  double east, north;  ///< rise / run
};
/// Bilinear at map coordinates x, y; the lattice must hold one ring of cells around them.
RasterSample sample(const Raster& r, const core::Lattice& l, double x, double y);

}  // namespace swath::filters
