// SPDX-License-Identifier: GPL-3.0-or-later
// Bridge decks: planes off the ground that lead from ground to ground.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/structure_cells.h"

namespace swath::filters {

enum class Deck : std::uint8_t { none, deck, terrain };

/// Metres of cells around a place that deck_cells depends on there.
double deck_cells_halo(double longest);

/// For every cell with a plane: `deck` where some straight way over planes of at most 15 % of grade leads to the ground's level on both
/// sides, together at most `longest` (m) long and somewhere `clearance` (m) above the ground, while the ways at right angles to it end
/// high in the air; and the cells that hang level together with such a one within 10 m. Ground up to `step` (m) below a deck's end is at
/// its level. `terrain` where ways in nearly all directions lead to the ground's level: ground that a ground filter left out.
std::vector<Deck> deck_cells(const StructureCells& cells, double longest, double clearance, double step);

}  // namespace swath::filters
