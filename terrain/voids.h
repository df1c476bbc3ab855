// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::terrain {

/// Points per cell of `window`, row-major as in core::Grid.
std::vector<std::uint32_t> count_points(const core::Block& block, const std::vector<std::uint32_t>& rows, const core::Lattice& window);

/// Gives the cells of `grid` that have no height their reason: `long_edge` where points stand in all four quadrants within `reach` (m)
/// eastward and northward of the cell, so that it is a hole wider than could be bridged; `no_data` otherwise: at or beyond the edge of
/// the points, or in the middle of a hole wider than twice the reach. A rule that looks no further than reach + one cell, so that tiles
/// agree (membership in the convex hull of the whole survey would not be such a rule).
void give_void_reasons(core::Grid& grid, const core::Block& block, const std::vector<std::uint32_t>& rows, double reach);

/// Voids of which `seen` (row-major as the grid) says that no beam came there, through gaps or not, become `never_seen`: more points of the
/// same flight would not have filled them.
void mark_never_seen(core::Grid& grid, const std::vector<bool>& seen);

}  // namespace swath::terrain
