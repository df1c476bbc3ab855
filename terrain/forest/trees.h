// SPDX-License-Identifier: GPL-3.0-or-later
// Single trees: tops and crowns.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/block.h"

namespace swath::terrain {

struct TreeOptions {
  double cell = 0.5;           ///< m, of the canopy's heights
  double least_height = 3.0;   ///< m, of a tree
  double window = 0.6;         ///< m: no other top is nearer than window + window_share * height
  double window_share = 0.14;  ///< of the height
};

struct Tree {
  double x = 0.0, y = 0.0, z = 0.0;      ///< of its highest return, m, relative to the block's origin
  double height = 0.0;                   ///< m above ground
  double crown_area = 0.0;               ///< m2
  std::vector<Eigen::Vector2d> crown{};  ///< convex outline of its cells, counter-clockwise, not closed
};

/// Metres of points around a place that its trees depend on.
double trees_halo(const TreeOptions& o);

/// The trees whose highest return is one of the first `own` points, by x and y. A top is the highest cell of the canopy's smoothed heights
/// (mean of 3 x 3 cells) within its window. A cell of the canopy belongs to the tree to which it is nearest in units of the tree's height,
/// at most 0.35 heights + 1 m away, where it is at least 0.4 times as high. Needs the columns height, classification, flags. Does not
/// depend on the order of the points.
std::vector<Tree> find_trees(const core::Block& b, size_t own, const TreeOptions& o);

}  // namespace swath::terrain
