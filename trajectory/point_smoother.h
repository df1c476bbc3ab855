// SPDX-License-Identifier: GPL-3.0-or-later
// The whole pass at once: constant velocity with white acceleration through all fixes, smoothed forward and backward (RTS).
#pragma once

#include <vector>

#include "trajectory/kinematic.h"

namespace swath::trajectory {

/// Holds the filtered and the smoothed state of every fix: 0.7 kB each.
class PointSmoother {
 public:
  /// Needs three fixes or more. The acceleration's level is that which makes the fixes most probable, axis by axis; gaps are bridged.
  explicit PointSmoother(PointFixes fixes);

  /// Square root of the acceleration's spectral density per axis, (m/s^2)/sqrt(Hz).
  const Eigen::Vector3d& acceleration() const { return acceleration_; }
  const std::vector<PointState>& states() const { return smoothed_; }
  /// The smoothed state at t, which lies between the first and the last fix.
  PointState at(double t) const;
  /// The smoothed state at a fix from all the others. The acceleration's level is still that of all fixes.
  PointState without(size_t fix) const;

 private:
  PointState::Matrix6 noise(double dt) const;
  PointState back(const PointState& filtered, const PointState& next) const;

  PointFixes fixes_;
  Eigen::Vector3d acceleration_;
  std::vector<PointState> filtered_, smoothed_;
};

/// Logarithm of the probability of one axis's fixes (up to a constant) under a density q of white acceleration, m^2/s^3.
double log_likelihood(const PointFixes& fixes, int axis, double q);

}  // namespace swath::trajectory
