// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::core {

/// One IMU's record in `body` axes (forward, right, down). Increment k covers [time[k] - step[k], time[k]]; where time[k-1] lies before
/// that interval, records are missing (a gap).
struct ImuData {
  std::vector<double> time;               ///< GPS time of the end of the interval, s, rising
  std::vector<double> step;               ///< length of the interval, s, > 0
  std::vector<Eigen::Vector3d> angle;     ///< integral of the angular rate against inertial space along the turning axes, rad
  std::vector<Eigen::Vector3d> velocity;  ///< integral of the specific force along the turning axes, m/s

  size_t size() const { return time.size(); }
};

}  // namespace swath::core
