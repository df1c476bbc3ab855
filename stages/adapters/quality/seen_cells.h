// SPDX-License-Identifier: GPL-3.0-or-later
// Where a survey has points at all: check points far from all of them lie outside.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::stages {

/// A square of the absolute lattice, of 25 m, that holds points; plain data.
struct SeenCell {
  std::int32_t i = 0, j = 0;
  auto operator<=>(const SeenCell&) const = default;
};

/// Of the first `own` points those that are neither withheld nor noise; sorted, each square once.
std::vector<SeenCell> seen_cells(const core::Block& block, std::size_t own);

/// Distance of a place from the nearest of the squares, m: up to a square's diagonal less than from the points; infinite where there is
/// none.
double away(const std::vector<SeenCell>& seen, const Eigen::Vector3d& at);

}  // namespace swath::stages
