// SPDX-License-Identifier: GPL-3.0-or-later
// What usually goes wrong between the records of a flight and its description: signs, units, axes, models.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/records/sensor.h"
#include "core/records/trajectory_data.h"

namespace swath::calib {

/// What a return is georeferenced with.
struct Chain {
  core::Scanner scanner;
  core::Calibration calibration;
};

/// One mistake, as the change that undoes it.
struct UsualMistake {
  enum class Kind {
    gross,   ///< moves returns by metres or more
    ranges,  ///< changes how wide a swath is
    small,   ///< moves returns by centimetres to a few metres
  };
  std::string_view name;                                  ///< as reports have it
  std::string what;                                       ///< "with the sign of roll reversed"
  std::string cure;                                       ///< "export the trajectory with roll positive right wing down"
  std::function<void(Chain&)> chain;                      ///< may be empty
  std::function<void(core::TrajectoryData&)> trajectory;  ///< may be empty
  Kind kind = Kind::gross;
  double heading = 0.0;  ///< rad, that it adds to all headings of the trajectory
};

/// All that change anything. `convergence`: rad, grid north of the survey's map clockwise from true north; 0 where there is none.
/// `antenna`: lever arm of the antenna in the body, m; 0 where it is not known.
std::vector<UsualMistake> usual_mistakes(const Chain& stated, double convergence, const Eigen::Vector3d& antenna = Eigen::Vector3d::Zero());

}  // namespace swath::calib
