// SPDX-License-Identifier: GPL-3.0-or-later
// The whole pass at once: the motion model through all fixes, smoothed forward and backward (RTS).
#pragma once

#include <vector>

#include "trajectory/kinematic.h"
#include "trajectory/motion_model.h"

namespace swath::trajectory {

/// Holds the filtered and the smoothed state of every fix: 1.5 kB each.
class PointSmoother {
 public:
  /// Needs three fixes or more; gaps are bridged.
  PointSmoother(PointFixes fixes, MotionModel model);

  const MotionModel& model() const { return model_; }
  /// The smoothed state at t, which lies between the first and the last fix. Its covariance is without the fixes' slow error.
  PointState at(double t) const;
  /// The smoothed state at a fix from all the others. The model is still that of all fixes.
  PointState without(size_t fix) const;

 private:
  using Vector9 = Eigen::Matrix<double, 9, 1>;
  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  /// Position, velocity, acceleration; east, north, up each.
  struct State {
    Vector9 x = Vector9::Zero();
    Matrix9 covariance = Matrix9::Zero();
  };
  static PointState point(const State& s, double time);
  State back(const State& filtered, const State& next, double dt, const PointMotion& motion) const;

  PointFixes fixes_;
  MotionModel model_;
  std::vector<State> filtered_, smoothed_;
};

}  // namespace swath::trajectory
