// SPDX-License-Identifier: GPL-3.0-or-later
// What a comparison of lines says of one point: its line's offset and its sigma.
#pragma once

#include <cstdint>
#include <map>

#include "core/block.h"

namespace swath::quality {

/// What is known of a run's lines. NaN where the points do not show it.
struct KnownLines {
  std::map<int, double> offsets;  ///< m, by line
  double scatter = 0, common = 0, residual = 0, common_horizontal = 0;
  int steep_places = 0;
  double shared() const;  ///< m, of what neighbours share of their errors of height; the scatter where no lines are compared
  double sigma() const;   ///< m, of one point's height
  /// m, radial. That it is as large along each axis as shared() counts as one steep place beside those that were compared.
  double horizontal_sigma() const;
};

/// Takes its line's offset from the height of every point.
void take_offsets(core::Block& block, const KnownLines& lines);

/// Gives the points that have no sigma_v (no column, or 0) these sigmas, m, `horizontal` radial; returns how many there were.
std::uint64_t give_sigmas(core::Block& block, double vertical, double horizontal);

}  // namespace swath::quality
