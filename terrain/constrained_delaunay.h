// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "terrain/predicates.h"

namespace swath::terrain {

/// Triangles of places, in any order, and the edges that were held, lower place first, ascending.
struct ConstrainedTriangles {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::pair<std::int32_t, std::int32_t>> held;
};

/// The constrained Delaunay triangulation of distinct places, near the one before in their order; cocircular polygons are cut as fans from
/// their vertex of least (x, y). Throws core::Error where edges cross between their vertices; `origin` is added to the place it names.
ConstrainedTriangles constrained_delaunay(const std::vector<Place>& places, const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                          const Place& origin);

}  // namespace swath::terrain
