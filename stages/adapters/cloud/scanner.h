// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stages/tile.h"

namespace swath::stages {

/// Where the scanner was at each point's time, relative to the block's origin, m; NaN where the trajectory does not reach. Needs column
/// time.
std::vector<Eigen::Vector3d> scanner_positions(const Context& context, const trajectory::Trajectory& trajectory, const core::Block& block,
                                               RunCache& cache);

}  // namespace swath::stages
