// SPDX-License-Identifier: GPL-3.0-or-later
// Where the scanner was at each return.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <vector>

#include "georef/map_patch.h"
#include "stages/stage.h"

namespace swath::stages {

/// Positions of the scanner from a trajectory, for the tiles of a stage that work at the same time.
class ScannerPositions {
 public:
  /// At each point's time, relative to the block's origin, m; NaN where the trajectory does not reach. Needs column time.
  std::vector<Eigen::Vector3d> of(const Context& context, const trajectory::Trajectory& trajectory, const core::Block& block) const;

 private:
  std::shared_ptr<const georef::MapPatches> patches(const Context& context) const;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const georef::MapPatches> patches_;
};

}  // namespace swath::stages
