// SPDX-License-Identifier: GPL-3.0-or-later
// Contour segments of any number of tiles joined to lines, one level at a time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/ring.h"
#include "terrain/contours.h"
#include "terrain/facets.h"

namespace swath::terrain {

/// One contour line in map coordinates, higher ground on its left (counter-clockwise round a summit).
struct ContourLine {
  std::int64_t level = 0;
  double height = 0.0;  ///< m
  bool is_index = false;
  bool closed = false;      ///< the last vertex then repeats the first; an open line ends at a void or at the survey's edge
  bool depression = false;  ///< closed round lower ground
  std::vector<Eigen::Vector2d> vertices;
};

/// Length of a line, CRS units (metres inside a run).
double length(const std::vector<Eigen::Vector2d>& vertices);

using core::signed_area;  // m2: positive round a summit, negative round a depression

/// Joins segments (any order, doubles allowed; one level at a time keeps memory small) to lines. Open lines start at their own end, closed
/// ones at their smallest edge key; lines are in the order of level and start key: the same answer for every tiling. Vertices that coincide
/// are one; what has no length is left out.
std::vector<ContourLine> join(std::vector<Segment> segments, const ContourOptions& options);

/// What a tile merge calls per level: join, leave out what is shorter than min_length or encloses less than min_area, and thin
/// (terrain/contour_shape.h) within the tolerance of `surface`, the model itself.
std::vector<ContourLine> contour_lines(std::vector<Segment> segments, const ContourOptions& options, Facets& surface);

}  // namespace swath::terrain
