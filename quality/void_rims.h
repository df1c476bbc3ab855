// SPDX-License-Identifier: GPL-3.0-or-later
// The ground around voids: does it lie as the shores of a water do?
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "quality/void_cells.h"

namespace swath::quality {

/// A piece of a void's rim, in a square of rim_side() of the absolute lattice; plain data.
struct RimPiece {
  std::int32_t i = 0, j = 0;            ///< of the square
  std::int32_t void_i = 0, void_j = 0;  ///< the cell of the void that a return of it is nearest to
  float low = 0.0F;                     ///< m, its lowest return
  float behind = 0.0F;  ///< m, median of the ground 3 to 6 m from the square's middle; not a number: fewer than five returns
};

/// m: 4 ANPS, the side of the smallest void.
inline double rim_side(double rule) { return 4.0 * rule; }
/// Metres of points around a window that pieces depend on.
inline double rim_halo(double rule) { return 6.0 + rim_side(rule); }

/// Pieces of the rims of `runs`, which rise by row and column: returns up to 1.5 ANPS beside a void. Heights behind are those of class
/// ground, of all last returns where the block has none. Of a square that two tiles hold each gives what its own voids have; their lows
/// differ.
std::vector<RimPiece> rims_of(const core::Block& block, const std::vector<VoidRun>& runs, const PulseSpacing& spacing);

/// Is the rim of one void a shore? In pieces of one square the lowest counts. It is where 8 pieces or more are known, the lowest returns of
/// 40 % of them lie within 0.3 m of a level (0.2 quantile of the 40 nearest; trees, boats and walls stand over the rest), the ground behind
/// rises by 0.1 m or more in 80 % of those and falls in at most 15 %, and the ground behind lies 0.2 m or more above the level.
bool is_shore(std::vector<RimPiece> rim);

}  // namespace swath::quality
