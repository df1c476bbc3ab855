// SPDX-License-Identifier: GPL-3.0-or-later
// How an antenna moves between its fixes: acceleration as a first-order Gauss-Markov process, its level found piece by piece by likelihood.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "trajectory/fix_window.h"

namespace swath::trajectory {

/// Acceleration of one axis: da = -a / time dt + sqrt(drive) dw. A short time makes it white, of density drive time^2; a long one makes its
/// rate white (Singer1970).
struct AxisMotion {
  double drive = 1.0;  ///< spectral density of what drives it, m^2/s^5
  double time = 1.0;   ///< correlation time, s

  double acceleration() const;  ///< its standard deviation, m/s^2
};
AxisMotion motion_of(double acceleration, double time);

/// Axes east, north, up.
using PointMotion = std::array<AxisMotion, 3>;

/// Position, velocity and acceleration of one axis over a step dt >= 0: transition, and the covariance that the motion adds.
Eigen::Matrix3d motion_transition(const AxisMotion& m, double dt);
Eigen::Matrix3d motion_noise(const AxisMotion& m, double dt);

/// What moves the antenna, and how much of a fix's stated covariance is white.
struct MotionModel {
  std::vector<double> start;        ///< of each piece, s, rising; the first holds before its start too
  std::vector<PointMotion> motion;  ///< of each piece
  /// White error of a fix: its standard deviation as a multiple of the stated one. What it leaves of the stated variance is an error that
  /// changes slowly: neighbouring fixes share it and no interpolation averages it out.
  Eigen::Vector3d white = Eigen::Vector3d::Ones(), slow = Eigen::Vector3d::Zero();

  /// The motion at t, or between two fixes that t lies between.
  const PointMotion& at(double t) const;
  Eigen::Matrix3d white_of(const Eigen::Matrix3d& stated) const;
  Eigen::Matrix3d slow_of(const Eigen::Matrix3d& stated) const;
};

/// The model under which the fixes are most probable. The correlation time is one per axis and record, the white share one for east and
/// north and one for height, the acceleration one per axis and piece. `pieces`: first fix of each piece, rising from 0. Three fixes or
/// more.
MotionModel fit_motion(const PointFixes& fixes, const std::vector<size_t>& pieces);

/// Logarithm of the probability of one axis's fixes [first, end), up to a constant; `white` as in MotionModel.
double log_likelihood(const PointFixes& fixes, size_t first, size_t end, int axis, const AxisMotion& motion, double white);

}  // namespace swath::trajectory
