// SPDX-License-Identifier: GPL-3.0-or-later
// Bridge decks in a raster of lowest returns whose objects are taken off.
#pragma once

#include "filters/ground/morphology.h"

namespace swath::filters {

/// Cells of 1 m.
struct DeckOptions {
  double steepest = 1.43;  ///< rise / run of the steepest ground
  double step = 0.5;       ///< m: what drops by more at an edge stands off the ground
};

/// Voids the decks in `surface` (the lowest returns, NaN where none) and in `ground` (NaN also where an object was taken off), there with
/// the cells that continue a taken-off deck on its level: an opening takes the middle of a deck, but keeps its ends, where a disk rests on
/// the bank.
/// A deck is what was taken off between two edges, at most deck_width apart, at which the surface falls more steeply than ground can;
/// towards its ends it goes on while both edges drop by the step.
void remove_decks(Raster& ground, Raster& surface, const DeckOptions& o);

constexpr int deck_width = 16;  ///< cells
extern const int deck_support;  ///< cells around a cell that decide on it

}  // namespace swath::filters
