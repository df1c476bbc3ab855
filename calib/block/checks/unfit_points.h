// SPDX-License-Identifier: GPL-3.0-or-later
// Points that an adjustment does without: image points that lost their weight (wrong control, one name for two points), parallel rays.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_inference.h"
#include "calib/block/image_block.h"

namespace swath::calib {

struct UnfitPoints {
  std::vector<char> of_point;                ///< 1: a point, not of control, that fits on fewer than two images
  std::vector<std::string> control, others;  ///< names
  std::vector<std::string> images;           ///< images more than a third of whose points have no weight
};

/// `weight`: per ray. Control: points most of whose image points have no weight.
UnfitPoints unfit_points(const ImageBlock& block, const std::vector<double>& weight);

/// Leaves out points whose rays are parallel, or whose position has a standard deviation of more than a third of the distance, if they are
/// at most a tenth: a block has thousands of tie points, and its user need not edit their file. True where there were any.
bool leave_out_parallel(ImageBlock& block, const BlockInference& found);

}  // namespace swath::calib
