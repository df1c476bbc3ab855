// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Rodrigues' formula and its inverse through the unit quaternion (Sola, "Quaternion kinematics for the error-state Kalman
// filter", 2017, eqs. 77, 103, 105). Deviation: below 1e-4 rad the coefficients are Taylor series cut after the cubic term; the cut is
// below 1e-19 of the result.
#include "core/geo/frames.h"

#include <cmath>
#include <numbers>

namespace swath::core {

namespace {
// cos(pitch) below this is gimbal lock: roll and heading are then one angle, given to heading. The matrix is met to this size.
constexpr double gimbal_cosine = 1e-10;
constexpr double small_angle = 1e-4;
}  // namespace

Eigen::Matrix3d matrix_of(const Attitude& a) {
  const double sr = std::sin(a.roll), cr = std::cos(a.roll);
  const double sp = std::sin(a.pitch), cp = std::cos(a.pitch);
  const double sh = std::sin(a.heading), ch = std::cos(a.heading);
  Eigen::Matrix3d R;
  R << ch * cp, ch * sp * sr - sh * cr, ch * sp * cr + sh * sr,  //
      sh * cp, sh * sp * sr + ch * cr, sh * sp * cr - ch * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

Attitude attitude_of(const Eigen::Matrix3d& R) {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  Attitude a;
  a.pitch = std::atan2(-R(2, 0), cos_pitch);
  const bool locked = cos_pitch < gimbal_cosine;
  a.heading = wrap_two_pi(locked ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0)));
  if (!locked) {
    // Roll from the matrix turned back by heading: near +-90 deg of pitch both angles are poorly known, their combination is not.
    const double sh = std::sin(a.heading), ch = std::cos(a.heading);
    a.roll = std::atan2(sh * R(0, 2) - ch * R(1, 2), ch * R(1, 1) - sh * R(0, 1));
  }
  return a;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

Eigen::Matrix3d exp_so3(const Eigen::Vector3d& rotation) {
  const double angle2 = rotation.squaredNorm();
  const double angle = std::sqrt(angle2);
  double sine_over = 0.0, versine_over = 0.0;  // sin(t)/t, (1 - cos(t))/t^2
  if (angle < small_angle) {
    sine_over = 1.0 - angle2 / 6.0;
    versine_over = 0.5 - angle2 / 24.0;
  } else {
    const double half = std::sin(0.5 * angle);
    sine_over = std::sin(angle) / angle;
    versine_over = 2.0 * half * half / angle2;
  }
  const Eigen::Matrix3d S = skew(rotation);
  return Eigen::Matrix3d::Identity() + sine_over * S + versine_over * S * S;
}

Eigen::Vector3d log_so3(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double half_sine = q.vec().norm();
  if (half_sine < small_angle) return (2.0 / q.w()) * (1.0 - half_sine * half_sine / (3.0 * q.w() * q.w())) * q.vec();
  return (2.0 * std::atan2(half_sine, q.w()) / half_sine) * q.vec();
}

double wrap_pi(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

double wrap_two_pi(double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  double wrapped = std::fmod(angle, turn);
  if (wrapped < 0.0) wrapped += turn;
  return wrapped >= turn ? 0.0 : wrapped;
}

}  // namespace swath::core
