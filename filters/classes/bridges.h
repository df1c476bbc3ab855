// SPDX-License-Identifier: GPL-3.0-or-later
// Bridge decks: planes off the ground that lead from ground to ground.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/classes/structure_cells.h"

namespace swath::filters {

struct BridgeLimits {
  double longest = 60.0;   ///< m
  double clearance = 2.0;  ///< m above the ground, where no returns show what is beside a deck
  double end = 2.0;        ///< m between the ends of a deck and the ground below them
  double step = 0.6;       ///< m between the deck and the ground a few metres on
};

/// Metres of cells around a place that deck_cells depends on there.
double deck_cells_halo(double longest);
/// Of these, how far from a cell of a deck the cells may lie that are linked with it.
double deck_spread();

/// 1 for every cell with a wide plane where some straight way over planes of at most 15 % of grade leads to the ground's level on both
/// sides, together at most `longest`, while at right angles to it the plane ends within 25 m on both sides: what is beside it lies a metre
/// lower on one side at least, or no beam came back from there, but from the banks beside both ends, and the plane is somewhere `clearance`
/// above the ground; one metre does where it joins the ground at one end. Planes nowhere a metre above the ground are not decks: crops
/// beside ditches look the same. Nor are planes less than 2 m above it with lower returns in the same cells: beams pass through crops. And
/// for the cells that are linked level with such a one over at most 10 m. Cells that `begun` does not touch begin no deck.
std::vector<std::uint8_t> deck_cells(const StructureCells& cells, const BridgeLimits& limits, const OwnBox& begun);

}  // namespace swath::filters
