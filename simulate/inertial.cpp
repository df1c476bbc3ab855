// SPDX-License-Identifier: GPL-3.0-or-later
// Strapdown equations in the local level frame (Savage 2000; Groves 2013, 5.4):
//   f_n = dv_n/dt + (2 w_ie + w_en) x v_n - g_n,  w_ib = w_nb + body_R_ned (w_ie + w_en).
// Increments by Gauss and Legendre with 4 nodes: error below 1e-13 rad and m/s over 5 ms of this flight.
#include "simulate/inertial.h"

#include <array>
#include <cmath>

namespace swath::simulate {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Transport rate, in ned.
Vector3d transport_rate(const Motion& m) {
  const double lat = m.pose.position.latitude, h = m.pose.position.height;
  const double M = core::meridian_radius(lat), N = core::prime_vertical_radius(lat);
  return {m.velocity.y() / (N + h), -m.velocity.x() / (M + h), -m.velocity.y() * std::tan(lat) / (N + h)};
}

/// Rate of body against ned, in body.
Vector3d attitude_turn(const Motion& m) {
  const double roll = m.pose.attitude.roll, pitch = m.pose.attitude.pitch;
  const double p1 = m.attitude_rate.x(), q1 = m.attitude_rate.y(), r1 = m.attitude_rate.z();
  return {p1 - r1 * std::sin(pitch), q1 * std::cos(roll) + r1 * std::sin(roll) * std::cos(pitch),
          -q1 * std::sin(roll) + r1 * std::cos(roll) * std::cos(pitch)};
}

}  // namespace

Inertial inertial_of(const Motion& m) {
  const double lat = m.pose.position.latitude;
  const Vector3d w_ie(core::wgs84::omega * std::cos(lat), 0, -core::wgs84::omega * std::sin(lat));
  const Vector3d w_en = transport_rate(m);
  const Vector3d gravity(0, 0, core::normal_gravity(lat, m.pose.position.height));
  const Matrix3d body_R_ned = core::matrix_of(m.pose.attitude).transpose();
  Inertial out;
  out.rate = attitude_turn(m) + body_R_ned * (w_ie + w_en);
  out.force = body_R_ned * (m.acceleration + (2 * w_ie + w_en).cross(m.velocity) - gravity);
  return out;
}

Vector3d velocity_at(const Motion& m, const Vector3d& lever) {
  const Matrix3d ned_R_body = core::matrix_of(m.pose.attitude);
  return m.velocity + ned_R_body * attitude_turn(m).cross(lever) + transport_rate(m).cross(ned_R_body * lever);
}

Increments increments_of(const Flight& flight, double t, double step) {
  constexpr std::array<double, 2> x{0.3399810435848563, 0.8611363115940526}, w{0.6521451548625461, 0.3478548451374538};
  Increments out{Vector3d::Zero(), Vector3d::Zero()};
  for (size_t i = 0; i < 2; ++i)
    for (const double sign : {-1.0, 1.0}) {
      const Inertial at = inertial_of(flight.motion(t - 0.5 * step + sign * 0.5 * step * x[i]));
      out.angle += 0.5 * step * w[i] * at.rate;
      out.velocity += 0.5 * step * w[i] * at.force;
    }
  return out;
}

}  // namespace swath::simulate
