// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::core {

/// Trajectory minus truth at the trajectory's own records. Vectors of one length; the sigmas are empty where the trajectory has none.
struct TrajectoryErrors {
  std::vector<double> time;                                     ///< GPS time, s
  std::vector<Eigen::Vector3d> position, attitude;              ///< north east down, m; roll pitch heading, rad
  std::vector<Eigen::Vector3d> position_sigma, attitude_sigma;  ///< of the trajectory, the same axes
  std::size_t outside = 0;                                      ///< records that the truth does not cover

  std::size_t size() const { return time.size(); }
};

}  // namespace swath::core
