// SPDX-License-Identifier: GPL-3.0-or-later
// The points that a patch is worked with: all near it, the lowest of each cell in the margin behind.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "filters/ground/patches.h"

namespace swath::filters {

struct PatchThinning {
  double whole = 10.0;  ///< m around the patch from which every point is taken
  double cell = 2.0;    ///< m: side of the cells behind it
  int across = 0;       ///< cells on a side of the patch with its margin
};

struct PatchPoints {
  std::vector<Eigen::Vector3d> points;      ///< m from `corner`, in the order of (x, y); no two at one (x, y): the lowest stands for them
  std::vector<std::uint32_t> point_of_row;  ///< of the patch's rows; `none` of those that are left out

  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// `corner`: the south-west corner of the cells, relative to the block's origin; those of the survey's own lattice, so that no result
  /// depends on a tile.
  PatchPoints(const core::Block& block, const Patch& patch, const Eigen::Vector3d& corner, const PatchThinning& how);
};

}  // namespace swath::filters
