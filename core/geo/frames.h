// SPDX-License-Identifier: GPL-3.0-or-later
// Frames and attitude by the project's conventions (docs/notation.md): body = forward, right, down; ned_R_body = Rz(heading) Ry(pitch)
// Rx(roll).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace swath::core {

/// Roll (right wing down), pitch (nose up), heading (from true north, clockwise); rad.
struct Attitude {
  double roll = 0.0, pitch = 0.0, heading = 0.0;
};

/// The matrix that takes vectors of `body` to `ned`: Rz(heading) Ry(pitch) Rx(roll). Also body_R_scanner from a boresight.
Eigen::Matrix3d matrix_of(const Attitude& a);
/// Inverse of matrix_of; heading in [0, 2 pi). At pitch = +-90 deg roll is set to 0.
Attitude attitude_of(const Eigen::Matrix3d& ned_R_body);

/// Matrix [v]x with [v]x w = v cross w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);
/// Rotation by a rotation vector, rad (Rodrigues; series near zero).
Eigen::Matrix3d exp_so3(const Eigen::Vector3d& rotation);
/// Rotation vector of a rotation matrix, length in [0, pi].
Eigen::Vector3d log_so3(const Eigen::Matrix3d& R);

/// Angle brought to (-pi, pi].
double wrap_pi(double angle);
/// Angle brought to [0, 2 pi).
double wrap_two_pi(double angle);

}  // namespace swath::core
