// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "trajectory/clock/motion.h"

namespace swath::trajectory {

/// Means over `width` (s) of both times and values, so that no delay comes in.
Motion averaged(const Motion& m, double width);

/// A record as a function of time: the cubic through the four records around (Lagrange), with its derivative. An interval of over five
/// median steps is a gap. The record must outlive it.
class MotionCurve {
 public:
  explicit MotionCurve(const Motion& m);
  /// False outside the record and in gaps.
  bool at(double t, Eigen::Vector3d& value, Eigen::Vector3d& rate) const;

 private:
  const Motion& m_;
  double longest_;
};

}  // namespace swath::trajectory
