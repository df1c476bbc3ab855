// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/flight.h"

#include <cmath>

namespace swath::simulate {

using Eigen::Vector3d;

LocalPlane::LocalPlane(const core::Geodetic& origin, double height)
    : origin_(origin),
      metres_per_latitude_(core::meridian_radius(origin.latitude) + height),
      metres_per_longitude_((core::prime_vertical_radius(origin.latitude) + height) * std::cos(origin.latitude)) {}

core::Geodetic LocalPlane::geodetic_of(const Vector3d& plane) const {
  return {origin_.latitude + plane.x() / metres_per_latitude_, origin_.longitude + plane.y() / metres_per_longitude_, plane.z()};
}

Vector3d LocalPlane::plane_of(const core::Geodetic& p) const {
  return {(p.latitude - origin_.latitude) * metres_per_latitude_, core::wrap_pi(p.longitude - origin_.longitude) * metres_per_longitude_,
          p.height};
}

Motion LocalPlane::motion_of(const State& s) const {
  Motion m;
  m.pose.position = geodetic_of(s.position);
  m.pose.attitude = {s.attitude.x(), s.attitude.y(), core::wrap_two_pi(s.attitude.z())};
  m.attitude_rate = s.attitude_rate;
  const double lat = m.pose.position.latitude, h = m.pose.position.height, up1 = s.velocity.z();
  // Rates of latitude and longitude, then velocities with the radii of the place.
  const double lat1 = s.velocity.x() / metres_per_latitude_, lat2 = s.acceleration.x() / metres_per_latitude_;
  const double lon1 = s.velocity.y() / metres_per_longitude_, lon2 = s.acceleration.y() / metres_per_longitude_;
  const double sin_lat = std::sin(lat), cos_lat = std::cos(lat);
  const double M = core::meridian_radius(lat), N = core::prime_vertical_radius(lat);
  const double w2 = 1 - core::wgs84::e2 * sin_lat * sin_lat;
  const double M_slope = 3 * M * core::wgs84::e2 * sin_lat * cos_lat / w2;  // dM / d latitude
  const double N_slope = N * core::wgs84::e2 * sin_lat * cos_lat / w2;      // dN / d latitude
  m.velocity = {lat1 * (M + h), lon1 * (N + h) * cos_lat, -up1};
  m.acceleration = {lat2 * (M + h) + lat1 * (M_slope * lat1 + up1),
                    lon2 * (N + h) * cos_lat + lon1 * ((N_slope * lat1 + up1) * cos_lat - (N + h) * sin_lat * lat1), -s.acceleration.z()};
  return m;
}

}  // namespace swath::simulate
