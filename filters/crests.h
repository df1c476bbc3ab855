// SPDX-License-Identifier: GPL-3.0-or-later
// Crests of the ground in a raster of lowest returns whose objects are taken off.
#pragma once

#include "filters/morphology.h"

namespace swath::filters {

/// Cells of 1 m.
struct CrestOptions {
  int widest = 50;   ///< cells across an object
  double cut = 0.5;  ///< m: what was cut off less deep is not looked for
};

/// Puts back into `ground` what an opening cut off from spurs, ridges and the rims of breaks, where no disk rests: cells that planes
/// through the ground beside them foretell, although the surface without them lies lower. `surface`: the lowest returns, NaN where none
/// and on decks; `ground`: NaN also where an object was taken off; `filled`: the lowest returns, holes filled.
void restore_crests(Raster& ground, const Raster& surface, const Raster& filled, const CrestOptions& o);

/// Cells around a cell that decide on it: of `ground` and `surface`, and of `filled`.
struct CrestReach {
  int ground, filled;
};
CrestReach crest_reach(const CrestOptions& o);

}  // namespace swath::filters
