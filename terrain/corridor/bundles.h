// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles: two or four wires side by side that a strand holds together.
#pragma once

#include <vector>

#include "terrain/corridor/strands.h"

namespace swath::terrain {

struct Bundle {
  int wires = 1;         ///< 1, 2 or 4
  double spacing = 0.0;  ///< m between neighbours; 0 for one wire
};

/// Whether the returns of a strand lie at two places across it, above one another, or both. Wires must be farther apart than about 1.2
/// widths of the beam; both places must be seen by every flight line, so that lines that do not fit together make no bundle. Three wires
/// are not distinguished from two or four.
Bundle bundle_of(const std::vector<WirePoint>& points, const Strand& strand);

}  // namespace swath::terrain
