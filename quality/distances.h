// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace swath::quality {

/// Squared distance of every cell's centre to that of the nearest cell of `mask` that is not 0, in cells; exact (Felzenszwalb2012).
/// Row by row, `nx` cells each; infinite where the mask is empty.
std::vector<float> squared_distances(const std::vector<std::uint8_t>& mask, int nx, int ny);

}  // namespace swath::quality
