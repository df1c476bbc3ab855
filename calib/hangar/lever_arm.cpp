// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Jubanski et al., eq 3 (vertical lever arm under tilt); Reis, Camargo, Tommaselli (2011), table 2 (signs of lever arms).
#include "calib/hangar/lever_arm.h"

#include <Eigen/Geometry>

namespace swath::calib {
namespace {

/// Forward, left, up to forward, right, down, and back.
const Eigen::DiagonalMatrix<double, 3> turn_over(1.0, -1.0, -1.0);

}  // namespace

Eigen::Vector3d point_from_antenna(const Eigen::Vector3d& antenna_ned, const core::Attitude& attitude, const Eigen::Vector3d& lever) {
  return antenna_ned - core::matrix_of(attitude) * lever;
}

double tilt_shift(const Eigen::Vector3d& lever, const core::Attitude& tilt) { return (core::matrix_of(tilt) * lever - lever).norm(); }

core::Attitude attitude_of_tilt(double omega, double phi) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(omega, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(phi, Eigen::Vector3d::UnitY())).matrix();
  return core::attitude_of(turn_over * R * turn_over);
}

Eigen::Vector3d vertical_lever_arm(double up, double omega, double phi) {
  const Eigen::Vector3d lever_body(0.0, 0.0, -up);
  return turn_over * (core::matrix_of(attitude_of_tilt(omega, phi)) * lever_body);
}

TiltedArm tilted(const Eigen::Vector3d& lever, const Eigen::Matrix3d& covariance, const core::Attitude& tilt, double tilt_sigma) {
  const Eigen::Matrix3d R = core::matrix_of(tilt);
  TiltedArm out;
  out.end = R * lever;
  out.shift = out.end - lever;
  // A small roll turns about the forward axis of the tilted body, a small pitch about the right axis of the level one.
  const Eigen::Matrix<double, 3, 2> by_tilt =
      (Eigen::Matrix<double, 3, 2>() << R.col(0).cross(out.end), Eigen::Vector3d::UnitY().cross(out.end)).finished();
  const Eigen::Matrix3d total = R * covariance * R.transpose() + tilt_sigma * tilt_sigma * by_tilt * by_tilt.transpose();
  out.sigma = total.diagonal().cwiseSqrt();
  return out;
}

}  // namespace swath::calib
