// SPDX-License-Identifier: GPL-3.0-or-later
// Crests of the ground in a raster of lowest returns whose objects are taken off.
#pragma once

#include "filters/ground/morphology.h"

namespace swath::filters {

/// The lowest returns in cells of 1 m, and what an opening made of them.
struct OpenedReturns {
  const Raster& lowest;  ///< NaN where no return is, and on decks
  const Raster& filled;  ///< with holes filled
  const Raster& opened;  ///< the lowest that the opening came to
  int widest;            ///< cells, half the width of the widest object
};

/// Puts back into `ground` (NaN where no return is and where an object was taken off) what the opening cut deeply off spurs, ridges and
/// the rims of breaks.
void restore_crests(Raster& ground, const OpenedReturns& r);

/// Cells around a cell of `ground` that decide on it; of `filled` and `lowest`, the widest disk and 2 more.
extern const int crest_support;

}  // namespace swath::filters
