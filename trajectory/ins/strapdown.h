// SPDX-License-Identifier: GPL-3.0-or-later
// Strapdown mechanisation in ECEF (Savage 1998; Groves 2013, 5.3): Earth rate, Coriolis and transport of the local level are in the frame
// itself; gravity is the normal gravity of WGS84 along the ellipsoid's normal.
#pragma once

#include <Eigen/Core>

#include "core/records/imu_data.h"

namespace swath::trajectory {

/// Position (ecef, m), velocity relative to the Earth (ecef axes, m/s) and attitude of the IMU at one instant.
struct NavState {
  double time = 0.0;  ///< GPS time, s
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  Eigen::Matrix3d ecef_R_body = Eigen::Matrix3d::Identity();
};

/// Motion of the body over a short interval, of either sign of `step`.
struct Increment {
  Eigen::Vector3d angle;     ///< rotation vector, rad: coning is in it
  Eigen::Vector3d velocity;  ///< integral of the specific force with sculling, but without the half rotation, m/s
  double step = 0.0;         ///< s
};

/// Increment k of a record with the coning and sculling terms of second order, which take the rate as linear over this and the
/// preceding interval (Savage 1998, eq 33 and part 2, eq 54). What they leave out at 200 Hz and 1 deg of coning at 5 Hz: 1e-7 rad/s (of
/// 2e-5).
Increment increment_of(const core::ImuData& imu, size_t k);

/// Normal gravity (with the centrifugal part) at a point, ecef, m/s^2.
Eigen::Vector3d gravity_at(const Eigen::Vector3d& ecef);
/// Its derivative by position, 1/s^2: point mass and centrifugal part (off by up to 0.7 %, of an effect of 3e-6 m/s^2 per metre).
Eigen::Matrix3d gravity_gradient_at(const Eigen::Vector3d& ecef);

/// Advances the state over an increment; with a negative step and negated increments it goes back in time the same way.
void advance(NavState& state, const Increment& increment);

/// The nearest rotation matrix: takes out the rounding of many products.
Eigen::Matrix3d orthonormal(const Eigen::Matrix3d& m);

}  // namespace swath::trajectory
