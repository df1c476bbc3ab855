// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/grid.h"

namespace swath::core {

/// The part of a tile's grid that lies in `window`'s lattice is copied there.
void paste(const Grid& tile, Grid& window);

/// Around the cells of a grid that have a height, with one cell more on each side where the grid has it; without cells where none has one.
Lattice known_part(const Grid& grid);

/// The cells of both lattices, which have cells of one size.
Lattice common_part(const Lattice& a, const Lattice& b);

}  // namespace swath::core
