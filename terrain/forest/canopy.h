// SPDX-License-Identifier: GPL-3.0-or-later
// What the returns of cells say of a forest: heights by percentile, canopy cover.
#pragma once

#include <array>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::terrain {

/// True for usable returns of vegetation, ground and what has no class: not of buildings, wires, towers, decks or water.
bool is_of_forest(const core::Block& b, size_t p);

constexpr std::array<int, 5> canopy_percentiles{25, 50, 75, 95, 100};

/// Per cell; not a number without first returns, and heights without returns as high as that.
struct CanopyCells {
  std::vector<float> cover;                                          ///< share of first returns at `least_height` or higher
  std::array<std::vector<float>, canopy_percentiles.size()> height;  ///< m above ground, of the returns at `least_height` or higher
  std::vector<float> first_returns;
};

/// Of all points of the block that lie in the window. Needs the columns height, classification, flags; without return numbers every return
/// is a first one. Percentiles are those of the sorted heights by linear interpolation. Does not depend on the order of the points.
CanopyCells canopy_cells(const core::Block& b, const core::Lattice& window, double least_height);

}  // namespace swath::terrain
