// SPDX-License-Identifier: GPL-3.0-or-later
// Raised surfaces that walls surround, however wide, and those that the rim of the data cuts.
#pragma once

#include <vector>

#include "filters/ground/morphology.h"

namespace swath::filters {

struct WallOptions {
  int longest = 180;            ///< cells: larger surfaces are ground; 0: none is looked for
  int widest = 50;              ///< cells: the same half of surfaces that the rim of the data cuts, whose other walls are not known
  double cell = 1.0;            ///< m
  double walled_at_rim = 0.25;  ///< share of walls in all of the border, of surfaces that the rim of the data cuts
  int farthest = 0;             ///< cells: longer surfaces are not reported either
};

/// A surface most of whose border that is seen is walls, and that stays: it is too long, or its walls are too few.
struct WalledHill {
  int i, j;              ///< its cell next to the middle
  float height;          ///< m, there
  double rise;           ///< m, mean over its walls
  double east, north;    ///< cells from the raster's corner, the middle
  double length, width;  ///< cells, of the rectangle with its moments
};

/// Voids in `lowest` (the lowest returns, NaN where none) the surfaces that end at walls wherever their end is seen: halls, and roofs of
/// which the data hold a part. What lies beyond the rim of the data is unknown: neither ground nor object. Returns what stays of those
/// wider than half of `widest`, which is all that an opening is sure of at the rim.
std::vector<WalledHill> remove_walled(Raster& lowest, const WallOptions& o);

/// Cells around a cell that decide on it.
int wall_support(const WallOptions& o);

}  // namespace swath::filters
