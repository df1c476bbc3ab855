// SPDX-License-Identifier: GPL-3.0-or-later
// The position is the trapezoid of the velocities: over 5 ms and a vibration of 1 m/s^2 at 10 Hz it is off by 2e-6 m, not growing.
#include "trajectory/ins/strapdown.h"

#include <Eigen/Geometry>

#include "core/geo/ellipsoid_normal.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Increment increment_of(const core::ImuData& imu, size_t k) {
  Increment out{imu.angle[k], imu.velocity[k], imu.step[k]};
  if (k == 0) return out;
  // Increments of the interval before, as if it had this one's length.
  const double share = imu.step[k] / imu.step[k - 1];
  const Vector3d angle = share * imu.angle[k - 1], velocity = share * imu.velocity[k - 1];
  out.angle += angle.cross(imu.angle[k]) / 12.0;
  out.velocity += (angle.cross(imu.velocity[k]) + velocity.cross(imu.angle[k])) / 12.0;
  return out;
}

Vector3d gravity_at(const Vector3d& ecef) {
  const core::EllipsoidNormal n = core::ellipsoid_normal(ecef);
  return -n.gravity() * n.up();
}

Matrix3d gravity_gradient_at(const Vector3d& ecef) {
  const double r = ecef.norm();
  const Vector3d u = ecef / r;
  Matrix3d out = core::wgs84::gm / (r * r * r) * (3.0 * u * u.transpose() - Matrix3d::Identity());
  out(0, 0) += core::wgs84::omega * core::wgs84::omega;
  out(1, 1) += core::wgs84::omega * core::wgs84::omega;
  return out;
}

void advance(NavState& s, const Increment& inc) {
  const double dt = inc.step;
  const Vector3d earth(0, 0, core::wgs84::omega);
  // Specific force in the axes of the interval's middle: half the body's turn and half the Earth's.
  Vector3d force = s.ecef_R_body * (inc.velocity + 0.5 * inc.angle.cross(inc.velocity));
  force -= 0.5 * dt * earth.cross(force);
  const Vector3d middle = s.position + 0.5 * dt * s.velocity;
  const Vector3d gravity = gravity_at(middle);
  // Coriolis with the velocity of the middle.
  const Vector3d half = s.velocity + 0.5 * (force + dt * (gravity - 2 * earth.cross(s.velocity)));
  const Vector3d after = s.velocity + force + dt * (gravity - 2 * earth.cross(half));
  s.position += 0.5 * dt * (s.velocity + after);
  s.velocity = after;
  Matrix3d turned = s.ecef_R_body * core::exp_so3(inc.angle);
  const double a = core::wgs84::omega * dt;  // the Earth turns by less than 1e-4 rad within a second: second order suffices
  const Vector3d x = turned.row(0), y = turned.row(1);
  turned.row(0) = (1 - 0.5 * a * a) * x + a * y;
  turned.row(1) = (1 - 0.5 * a * a) * y - a * x;
  s.ecef_R_body = turned;
  s.time += dt;
}

Matrix3d orthonormal(const Matrix3d& m) { return Eigen::Quaterniond(m).normalized().toRotationMatrix(); }

}  // namespace swath::trajectory
