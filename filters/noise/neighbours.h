// SPDX-License-Identifier: GPL-3.0-or-later
// Distances between neighbouring points.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::filters {

constexpr int most_neighbours = 100;

/// Mean distance (m, 3D) of each point with `wanted` to its k nearest neighbours among the points with `takes_part`, itself excepted.
/// Neighbours absent within `reach` (m) count as lying at `reach`: a point that has none gets exactly `reach`. NaN for the other points.
/// k from 1 to most_neighbours. Exact; the result depends neither on the order of the points nor on those farther than `reach`.
std::vector<double> mean_neighbour_distance(const core::Block& b, const std::vector<std::uint8_t>& takes_part,
                                            const std::vector<std::uint8_t>& wanted, int k, double reach);

}  // namespace swath::filters
