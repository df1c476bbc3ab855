// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines made into solids.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "terrain/buildings/outline.h"

namespace swath::terrain {

enum class Boundary { ground, wall, roof };

/// A plane piece of a solid's boundary. The first ring runs counter-clockwise as seen from outside, holes the other way; not closed.
struct SolidFace {
  Boundary kind = Boundary::wall;
  std::vector<std::vector<Eigen::Vector3d>> rings;
};
using Solid = std::vector<SolidFace>;

/// The outline as a horizontal surface, seen from above.
SolidFace level_face(const Outline& outline, double height, Boundary kind);

/// The block over an outline between two heights: ground seen from below, walls, roof. Empty where it would have no volume.
Solid block_over(const Outline& outline, double bottom, double top);

/// Is every edge used twice, once in each direction? Vertices are those of equal coordinates.
bool is_closed(const Solid& solid);

/// m3; positive where the faces look outwards. Of a closed solid.
double volume(const Solid& solid);

}  // namespace swath::terrain
