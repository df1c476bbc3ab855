// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace swath::quality {

/// Squared distance of every cell's centre to that of the nearest cell of `mask` that is not 0, in cells; exact (Felzenszwalb2012).
/// Row by row, `nx` cells each; infinite where the mask is empty.
std::vector<float> squared_distances(const std::vector<std::uint8_t>& mask, int nx, int ny);

/// 1 where the nearest cell of `mask` that is not 0 is at most `radius` cells away, in [0, 250), else 0: squared_distances <= radius^2, in
/// a tenth of its time for a few cells.
std::vector<std::uint8_t> cells_within(const std::vector<std::uint8_t>& mask, int nx, int ny, double radius);

}  // namespace swath::quality
