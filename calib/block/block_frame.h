// SPDX-License-Identifier: GPL-3.0-or-later
// The local Cartesian frame of a block: east, north, up at its middle, or the frame of the data where they are local themselves.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "core/geo/crs.h"

namespace swath::calib {

/// For one thread: copies share what PROJ holds.
class BlockFrame {
 public:
  /// `crs`: "local", or a CRS with PROJ; `middle`: a point of the block in it.
  BlockFrame(const std::string& crs, const Eigen::Vector3d& middle);

  bool is_local() const { return !to_ecef_; }
  /// Throws core::Error where PROJ has no result.
  Eigen::Vector3d local_of(const Eigen::Vector3d& map) const;
  Eigen::Vector3d map_of(const Eigen::Vector3d& local) const;
  /// East, north and up at a point: of the grid, and by true north.
  Eigen::Matrix3d local_R_grid(const Eigen::Vector3d& local) const;
  Eigen::Matrix3d local_R_true(const Eigen::Vector3d& local) const;
  const Eigen::Vector3d& middle() const { return middle_; }  ///< of the CRS

 private:
  Eigen::Vector3d ecef_of(const Eigen::Vector3d& local) const { return origin_ + ecef_R_local_ * local; }
  Eigen::Vector3d middle_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  ///< ecef
  Eigen::Matrix3d ecef_R_local_ = Eigen::Matrix3d::Identity();
  std::shared_ptr<const core::Transform> to_ecef_, from_ecef_;
};

/// Columns east, north, up in ecef.
Eigen::Matrix3d ecef_R_enu(const Eigen::Vector3d& ecef);

}  // namespace swath::calib
