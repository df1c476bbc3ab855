// SPDX-License-Identifier: GPL-3.0-or-later
// Contour segments of any number of tiles joined to lines, one level at a time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ring.h"
#include "terrain/contours/contour_line.h"
#include "terrain/contours/contours.h"
#include "terrain/contours/facets.h"

namespace swath::terrain {

/// Length of a line, CRS units (metres inside a run).
double length(const std::vector<Eigen::Vector2d>& vertices);

using core::signed_area;  // m2: positive round a summit, negative round a depression

/// Joins segments (any order, doubles allowed; one level at a time keeps memory small) to lines. Open lines start at their own end, closed
/// ones at their smallest edge key; lines are in the order of level and start key: the same answer for every tiling. Vertices that coincide
/// are one; what has no length is left out.
std::vector<ContourLine> join(std::vector<Segment> segments, const ContourOptions& options);

struct DrawnLines {
  std::vector<ContourLine> lines;
  size_t left_out = 0;  ///< shorter than min_length, or around less than min_area
};

/// What a tile merge calls per level: join, leave out, and thin (terrain/contours/contour_shape.h) within the tolerance of `surface`, the
/// model itself.
DrawnLines contour_lines(std::vector<Segment> segments, const ContourOptions& options, Facets& surface);

}  // namespace swath::terrain
