// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/block.h"

namespace swath::io {

/// Moves points that lie exactly on the eastern or northern rim of a survey inside by a thousandth of the file's step, which no product
/// shows: cells and tiles are half open, and a square kilometre given with both its rims would have a further row and column of them with
/// some few points each. `rim`: largest coordinates of all files, `step`: of the file's whole numbers, both in the block's unit.
void keep_rim_inside(core::Block& block, const Eigen::Vector2d& rim, const Eigen::Vector2d& step);

}  // namespace swath::io
