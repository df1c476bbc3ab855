// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a triangulation as plain numbers, and the one way in which polygons inscribed in a circle are cut.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "terrain/tin/predicates.h"

namespace swath::terrain {

constexpr std::int32_t beyond = -1;  ///< the vertex at infinity, which every edge of the hull has on its outer side

/// v: vertices, counter-clockwise; n[k]: the face across the edge opposite v[k].
struct Face {
  std::array<std::int32_t, 3> v, n;
  bool is_finite() const { return (v[0] | v[1] | v[2]) >= 0; }
  /// Where `face` stands among n; it must.
  int side_of(std::int32_t face) const { return n[0] == face ? 0 : n[1] == face ? 1 : 2; }
  /// Of a face that is not finite: where the vertex at infinity stands among v.
  int corner_beyond() const { return v[0] == beyond ? 0 : v[1] == beyond ? 1 : 2; }
};

constexpr int ccw(int k) { return k == 2 ? 0 : k + 1; }
constexpr int cw(int k) { return k == 0 ? 2 : k - 1; }

using FacePair = std::array<std::int32_t, 2>;

/// Cuts the polygons that `pairs` of neighbours with one circle make up as fans from their vertex of least (x, y).
void cut_as_fans(std::vector<Face>& faces, const std::vector<Place>& places, const std::vector<FacePair>& pairs);

}  // namespace swath::terrain
