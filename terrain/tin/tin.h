// SPDX-License-Identifier: GPL-3.0-or-later
// The Delaunay triangulation of chosen points, made so that any part of it is the same whatever else was triangulated.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/block.h"
#include "terrain/tin/circumcircle.h"
#include "terrain/tin/predicates.h"
#include "terrain/tin/rectangle.h"

namespace swath::terrain {

/// Triangulated irregular network. Coordinates are those of the Block (map frame minus its origin, m).
/// The order of the vertices has no meaning. The three of a triangle ascend in (x, y).
struct Tin {
  std::vector<double> x, y, z;          ///< vertices, m
  std::vector<float> sigma_v, sigma_h;  ///< m, per vertex; empty where the Block has no such column
  std::vector<std::uint32_t> row;       ///< of the Block, per vertex; its size and more at vertices of constraints
  std::vector<std::array<std::int32_t, 3>> triangles;
  /// For each triangle its neighbours across the edges opposite to vertex 0, 1, 2; -1 where there is none.
  std::vector<std::array<std::int32_t, 3>> across;
  /// Edges held by constraints, lower vertex first; ascending; also those whose triangles are left out.
  std::vector<std::pair<std::int32_t, std::int32_t>> constrained;
  std::vector<Place> duplicates;  ///< of the points left out because another stands at the same (x, y), not higher
  size_t not_finite = 0;          ///< points left out because x, y or z is not finite

  size_t size() const { return triangles.size(); }
  Place place(std::int32_t v) const { return {x[static_cast<size_t>(v)], y[static_cast<size_t>(v)]}; }
  /// Whether triangle `a` stands before `b` in the order of (x, y) of their vertices, first vertex first.
  bool is_before(std::int32_t a, std::int32_t b) const;
};

Circumcircle circumcircle(const Tin& tin, std::int32_t triangle);

/// Delaunay triangulation of the points at `rows`, less the triangles whose circumradius is over `max_radius` (m).
/// Of points at one (x, y) the lowest stands. Where more than three points lie exactly on one empty circle their polygon is cut as a fan
/// from its vertex of least (x, y). Fewer than three points, or all on one line, give no triangles.
///
/// The result does not depend on the order of the points, and it is local: over any place q the triangle is the same for every set of
/// points that agrees within 2 max_radius of q (proof in the source).
///
/// Of the triangles those count that touch `where`; beyond it some may be others or missing. Points far from it cost little.
Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows,
                double max_radius = std::numeric_limits<double>::infinity(), const Rectangle& where = {});

/// Vertices and edges that a triangulation must hold (breaklines). Block frame, m. Edges touch one another at vertices only.
struct Constraints {
  std::vector<double> x, y, z;
  std::vector<float> sigma_v;                                ///< m, per vertex
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;  ///< of vertices
  bool empty() const { return edges.empty(); }
};

/// The constrained Delaunay triangulation of the points at `rows` and the constraints, otherwise as above: a vertex of the constraints
/// stands where a point has its (x, y); every constraint is an edge. It is local in the same sense, where the constraints that come
/// within 2 max_radius of q are the same (proof in the source). Throws core::Error where constraints cross between their vertices.
Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows, const Constraints& constraints,
                double max_radius = std::numeric_limits<double>::infinity(), const Rectangle& where = {});

}  // namespace swath::terrain
