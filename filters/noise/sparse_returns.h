// SPDX-License-Identifier: GPL-3.0-or-later
// Returns around which their own flight line has far fewer than is usual near by: pulses that did not come back.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/bins.h"

namespace swath::filters {

struct SparseReturns {
  std::vector<std::uint8_t> sparse;  ///< 1 per such row of the block
  std::vector<double> usual;         ///< per cell of the bins: usual number of returns of the line that has most
};

constexpr int sparse_circle = 2;                               ///< cells: largest radius of the circle in which a return is judged
constexpr double sparse_returns_reach = sparse_circle + 24.0;  ///< cells around a place that sparse_returns depends on there

/// Judges the binned points. Usual is the number of returns in a cell that half of a line's returns in the 40 x 40 cells around (of squares
/// of 8 cells) have at most: voids do not pull it down. A return is sparse where the circle around it in which 50 of its line would be
/// usual holds at most `share` of that. Without column strip all are one line's. Does not depend on the order of the points.
SparseReturns sparse_returns(const core::Block& b, const Bins& bins, double share);

}  // namespace swath::filters
