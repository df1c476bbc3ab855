// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "terrain/tin/faces.h"

namespace swath::terrain {

/// Faces in any order, those beyond the hull with them, and the edges that were held, lower vertex first, ascending.
struct ConstrainedFaces {
  std::vector<Face> faces;
  std::vector<std::pair<std::int32_t, std::int32_t>> held;
};

/// The constrained Delaunay triangulation of distinct places, near the one before in their order; cocircular polygons are cut as fans from
/// their vertex of least (x, y). Throws core::Error where edges cross between their vertices; `origin` is added to the place it names.
ConstrainedFaces constrained_delaunay(const std::vector<Place>& places, const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                      const Place& origin);

}  // namespace swath::terrain
