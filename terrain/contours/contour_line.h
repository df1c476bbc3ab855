// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

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

}  // namespace swath::terrain
