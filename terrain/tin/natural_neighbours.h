// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "terrain/tin/tin.h"

namespace swath::terrain {

/// Natural neighbour interpolation of a TIN's heights (Sibson 1981, "A brief description of natural neighbour interpolation").
class NaturalNeighbours {
 public:
  /// The TIN is held by reference.
  explicit NaturalNeighbours(const Tin& tin) : tin_(tin) {}

  /// Height at (x, y), m (Block frame), which `triangle` covers. The same bits for every numbering of the triangles. Where the natural
  /// neighbours reach beyond the triangles that are there, or over a constrained edge, they are not all known: the triangle's plane.
  double height(std::int32_t triangle, double x, double y) const;

 private:
  const Tin& tin_;
};

}  // namespace swath::terrain
