// SPDX-License-Identifier: GPL-3.0-or-later
// Which columns a function on the points of a tile works with. It stands beside the function, as halo() does:
//
//   core::TileColumns columns(const SmrfOptions&);
//
// The function gets these columns and no others, and only what it gives is kept.
#pragma once

#include "core/block.h"

namespace swath::core {

struct TileColumns {
  ColumnSet needs;    ///< a plan without them is refused
  ColumnSet reads{};  ///< where they are there
  ColumnSet gives{};
};

}  // namespace swath::core
