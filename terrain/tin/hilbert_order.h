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

/// The numbers `first` to `last` - 1 of places that lie along the curve, in the order in which a triangulation by insertion is quickest:
/// rows of 4096, each from a coarse selection to those between (Amenta, Choi & Rote 2003, "Incremental constructions con BRIO"). In a row
/// from one end to the other the triangles ahead of it would be long and each new place would change more of them.
std::vector<std::int32_t> from_coarse_to_fine(std::int32_t first, std::int32_t last);

}  // namespace swath::terrain
