// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "core/block.h"
#include "core/grid.h"

namespace swath::filters {

/// Height of each of the first `own` points above the terrain, into column `height` (m): z minus the terrain's height,
/// bilinear between the four cell centres around the point; cells without a height drop out and the weights of the others
/// are scaled up. Where all four are void the height is NaN. Returns the number of those points.
/// `terrain` must hold one ring of cells around the points.
std::uint64_t height_above(const core::Grid& terrain, core::Block& block, size_t own);

}  // namespace swath::filters
