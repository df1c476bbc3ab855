// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::trajectory {

/// Values over time: places (m, Cartesian axes common to both records) or turn rates (rad/s; a single rate in x). Times rise; both records
/// count from the same instant, best a near one: a double holds GPS seconds to 0.24 us only.
struct Motion {
  std::vector<double> time;  ///< s
  std::vector<Eigen::Vector3d> value;
};

}  // namespace swath::trajectory
