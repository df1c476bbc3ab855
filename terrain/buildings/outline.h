// SPDX-License-Identifier: GPL-3.0-or-later
// The rim of a set of triangles as rings, and rings as outlines of buildings: simplified, and squared where the building is rectangular.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "terrain/tin/tin.h"

namespace swath::terrain {

/// Not closed: the last vertex is not the first.
using Ring = std::vector<Eigen::Vector2d>;

/// An area with holes; the outer ring runs counter-clockwise, holes clockwise. m, relative to the points' origin.
struct Outline {
  Ring outer;
  std::vector<Ring> holes;
  double area() const;  ///< m2
  bool holds(const Eigen::Vector2d& p) const;
};

/// Adds the hole where it lies within the outer ring and apart from the other holes; false where it does not.
bool add_hole(Outline& outline, const Ring& hole);

/// Triangles of a TIN that are joined by edges: those of one part, ascending.
using TrianglePart = std::vector<std::int32_t>;

/// The parts whose triangles have one label, by their first triangle; those with a label below 0 are of none.
std::vector<TrianglePart> parts_of(const Tin& tin, std::vector<std::int32_t> label);
/// The parts of all triangles.
std::vector<TrianglePart> parts_of(const Tin& tin);

/// The rim of one part, holes smaller than `least_hole` (m2) filled. Rings are simple: where two parts of the rim touch at a vertex they
/// are taken apart there, and the largest ring counts.
Outline rim_of(const Tin& tin, const TrianglePart& part, double least_hole);

struct ShapeOptions {
  double movement = 1.0;              ///< m: no place of the rim is moved farther; a corner lies at most 1.25 times as far off it
  double outwards = 0.0;              ///< m that every side is moved outwards: the outermost returns lie within the roof's edge
  bool square = true;                 ///< give sides of rectangular buildings two directions
  std::optional<double> direction{};  ///< rad from east, of one of them, where it is known: half the sides' length is enough then
};

/// What became of a ring.
struct ShapedRing {
  Ring ring;
  std::optional<double> direction{};  ///< of its sides, rad from east, where it was squared
};

/// A ring with few vertices. Corners by Douglas and Peucker (1973) within half the movement allowed; sides by least squares through the
/// vertices between two corners, moved outwards (to the right of their direction) by 1.5 times the rim's rms off them. Squared where 80 %
/// of the sides' length lies within 15 deg of two directions at right angles: such sides get these directions, jogs smaller than half the
/// movement go, and so do oblique pieces that round off a corner by at most 1.25 of it. A result that moves a
/// place of the ring farther than allowed, or that is not simple, is given up: first the squares, then the fitted sides, then fewer
/// corners; the ring as it is stays last. Empty where the ring has fewer than three vertices.
ShapedRing shape_ring(const Ring& ring, const ShapeOptions& o);

/// Vertices of a ring kept by Douglas and Peucker (1973), as indices, ascending.
std::vector<std::size_t> corners_of(const Ring& ring, double tolerance);

/// Do no two sides meet but neighbours at their vertex?
bool is_simple(const Ring& ring);

/// m from a place to the nearest of the ring's sides.
double distance_to(const Ring& ring, const Eigen::Vector2d& p);

}  // namespace swath::terrain
