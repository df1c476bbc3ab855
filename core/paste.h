// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/grid.h"

namespace swath::core {

/// The part of a tile's grid that lies in `window`'s lattice is copied there.
void paste(const Grid& tile, Grid& window);

}  // namespace swath::core
