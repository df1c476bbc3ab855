// SPDX-License-Identifier: GPL-3.0-or-later
// What a lattice of cells shows of decks among ground: their level, and what lies beside and below them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::filters {

/// Per cell; heights m, as in the block, NaN where none.
struct DeckHeights {
  std::vector<float> top;            ///< highest ground, as the water below may be ground too; without ground the highest return
  std::vector<float> low;            ///< lowest return that is no low outlier
  std::vector<std::uint8_t> ground;  ///< 1: top is ground
};

/// Cells of the lattice around that decide on a cell.
constexpr int deck_heights_reach = 5;

/// Of the usable returns; the lattice must hold them. Low outliers are returns other than ground and water that lie 1.5 m or more below all
/// ground and water within deck_heights_reach cells: groups of them below a field look like what is beside a deck.
DeckHeights deck_heights(const core::Block& b, const core::Lattice& l);

}  // namespace swath::filters
