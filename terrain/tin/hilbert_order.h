// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "terrain/tin/predicates.h"

namespace swath::terrain {

/// One place's cell on the curve and its number.
struct OnCurve {
  std::uint32_t cell, number;
};

/// The numbers of places in the order of a Hilbert curve (Hilbert 1891) through their bounding box: near ones mostly follow one another.
/// Equal places have one cell; within a cell numbers ascend. Places must be finite, fewer than 2^32.
std::vector<OnCurve> along_hilbert_curve(const std::vector<Place>& places);

}  // namespace swath::terrain
