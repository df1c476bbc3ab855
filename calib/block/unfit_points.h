// SPDX-License-Identifier: GPL-3.0-or-later
// Points whose image points lost their weight in a robust adjustment: wrong control, one name for two points.
#pragma once

#include <string>
#include <vector>

#include "calib/block/image_block.h"

namespace swath::calib {

struct UnfitPoints {
  std::vector<char> of_point;                ///< 1: a point, not of control, that fits on fewer than two images
  std::vector<std::string> control, others;  ///< names
  std::vector<std::string> images;           ///< images more than a third of whose points have no weight
};

/// `weight`: per ray. Control: points most of whose image points have no weight.
UnfitPoints unfit_points(const ImageBlock& block, const std::vector<double>& weight);

}  // namespace swath::calib
