// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "terrain/tin/delaunay.h"
#include "terrain/tin/rectangle.h"

namespace swath::terrain {

/// Finds which points a triangulation needs so that its faces that touch a rectangle are those of all points, but for faces whose
/// circumradius is over `max_radius` (proof in terrain/tin/tin.cpp).
class Surroundings {
 public:
  /// `rows`: all points, finite. Held by reference.
  Surroundings(const core::Block& block, const std::vector<std::uint32_t>& rows, const Rectangle& where, double max_radius);

  /// The rows to begin with: in the rectangle and near it.
  std::vector<std::uint32_t> first();
  /// Further rows that the triangulation of all that were handed out needs; none where the faces that touch the rectangle are settled.
  /// Looks at the faces with a vertex that came since the last call.
  std::vector<std::uint32_t> needed(const Delaunay& dt, const std::vector<Place>& places);

 private:
  void mark(const Face& face, const std::vector<Place>& places);
  void mark_disc(double x, double y, double radius, const Rectangle& part);
  void mark_half_plane(const Place& a, const Place& b);
  Rectangle cell(std::int32_t c) const;
  /// Whether a cell comes near the part of the rectangle that a face covers.
  bool is_near(const Rectangle& cell, const Rectangle& part) const;

  const core::Block& block_;
  const std::vector<std::uint32_t>& rows_;
  Rectangle where_, near_;  // near_: whose points were handed out first
  Place corner_;            // south-west of the cells
  double side_ = 1.0;       // of a cell, m
  double reach_;            // m: diameter of the widest disc that counts
  std::int32_t nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> start_;   // of each cell within sorted_
  std::vector<std::uint32_t> sorted_;  // rows beyond near_ by cell
  std::vector<std::int32_t> left_;     // cells with rows that were not handed out
  std::vector<std::uint8_t> state_;    // of a cell: 0 empty or handed out, 1 not handed out, 2 needed
  std::int32_t settled_ = 0;           // vertices whose faces were looked at
};

}  // namespace swath::terrain
