// SPDX-License-Identifier: GPL-3.0-or-later
// Planes and ground by cells of 1 m of the survey's lattice: what hangs together, and how large it is.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "filters/bins.h"

namespace swath::filters {

/// Row-major as in core::Grid; heights relative to the block's origin, m.
struct StructureCells {
  core::Lattice lattice;
  std::vector<float> plane;   ///< highest planar point; NaN where none
  std::vector<float> height;  ///< of that point above ground
  std::vector<float> ground;  ///< lowest point of class ground; NaN where none

  bool has_plane(size_t c) const { return plane[c] == plane[c]; }
  bool has_ground(size_t c) const { return ground[c] == ground[c]; }
};

constexpr double structure_cell = 1.0;  ///< m
constexpr int structure_link = 2;       ///< cells: those up to so far apart hang together, so that one empty cell parts nothing

/// Cells of the planar points and of the points of class ground; needs columns classification and height.
StructureCells structure_cells(const core::Block& b, const std::vector<std::uint8_t>& planar);

/// Cells that hang together with cell (i, j) by links from a cell to one up to structure_link away for which `linked(from, to)` holds,
/// within the square of `radius` cells around (i, j); the search ends with the cell for which `enough(cell, count so far)` holds. True
/// where there was one. (i, j) itself counts. The result depends on nothing outside the square.
bool grow(const core::Lattice& l, int i, int j, int radius, const std::function<bool(size_t, size_t)>& linked,
          const std::function<bool(size_t, int)>& enough);

}  // namespace swath::filters
