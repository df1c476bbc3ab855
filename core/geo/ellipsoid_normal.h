// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of a place without its angles: for what is done at every record, where arc tangents and their sines would be most of the work.
// In geodesy.cpp, beside geodetic_of, whose iteration it shares.
#pragma once

#include <Eigen/Core>

namespace swath::core {

/// Latitude and longitude by their sines and cosines; height above the WGS 84 ellipsoid, m.
struct EllipsoidNormal {
  double sin_latitude, cos_latitude, sin_longitude, cos_longitude, height;

  /// Columns north, east, down in ecef: ecef_R_ned(latitude, longitude).
  Eigen::Matrix3d ecef_R_ned() const;
  Eigen::Vector3d up() const { return {cos_latitude * cos_longitude, cos_latitude * sin_longitude, sin_latitude}; }
  /// normal_gravity(latitude, height), m/s^2.
  double gravity() const;
};

/// The place of geodetic_of(ecef), to rounding. On the axis the longitude counts as 0.
EllipsoidNormal ellipsoid_normal(const Eigen::Vector3d& ecef);

}  // namespace swath::core
