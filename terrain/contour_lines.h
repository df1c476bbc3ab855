// SPDX-License-Identifier: GPL-3.0-or-later
// Contour segments of any number of tiles joined to lines, one level at a time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "terrain/contours.h"

namespace swath::terrain {

/// One contour line in map coordinates, higher ground on its left (counter-clockwise round a summit).
struct ContourLine {
  std::int64_t level = 0;
  double height = 0.0;  ///< m
  bool is_index = false;
  bool closed = false;  ///< the last vertex then repeats the first; an open line ends at a void or at the survey's edge
  std::vector<Eigen::Vector2d> vertices;
};

/// Length of a line, CRS units (metres inside a run).
double length(const std::vector<Eigen::Vector2d>& vertices);

/// Joins segments (any order, doubles allowed; one level at a time keeps memory small) to lines. Open lines start at their own end, closed
/// ones at their smallest edge key; lines are in the order of level and start key: the same answer for every tiling. Vertices that coincide
/// are one; what has no length is left out. No simplification yet.
std::vector<ContourLine> join(std::vector<Segment> segments, const ContourOptions& options);

/// Douglas and Peucker (1973): no removed vertex is farther than `tolerance` from the line that replaces it. Ends of open lines stay; a
/// closed line keeps its first vertex and at least three distinct ones. Lines of two levels may come to cross where they are closer to
/// each other than twice the tolerance.
std::vector<Eigen::Vector2d> simplify(const std::vector<Eigen::Vector2d>& vertices, bool closed, double tolerance);

/// What a tile merge calls per level: join, leave out what is shorter than min_length, simplify.
std::vector<ContourLine> contour_lines(std::vector<Segment> segments, const ContourOptions& options);

}  // namespace swath::terrain
