// SPDX-License-Identifier: GPL-3.0-or-later
// The WGS84 ellipsoid, its frames and its gravity (coordinate reference systems: core/geo/crs.h).
#pragma once

#include <Eigen/Core>

#include "core/geo/crs.h"

namespace swath::core {

/// WGS84 defining and derived constants (NIMA TR8350.2).
namespace wgs84 {
constexpr double a = 6378137.0;            ///< semi-major axis, m
constexpr double f = 1.0 / 298.257223563;  ///< flattening
constexpr double b = a * (1.0 - f);        ///< semi-minor axis, m
constexpr double e2 = f * (2.0 - f);       ///< first eccentricity squared
constexpr double gm = 3.986004418e14;      ///< m^3/s^2
constexpr double omega = 7.292115e-5;      ///< rotation, rad/s
}  // namespace wgs84

/// Latitude, longitude (rad), ellipsoidal height (m).
struct Geodetic {
  double latitude = 0.0, longitude = 0.0, height = 0.0;
};

Eigen::Vector3d ecef_of(const Geodetic& g);
/// Closed to 1e-9 m for heights from -10 km to 10 000 km, beside the rounding of the coordinates themselves (their last place is
/// 0.9e-9 m on the ground, 1.9e-9 m above 2000 km). Undefined at the very centre. Longitude in [-pi, pi].
Geodetic geodetic_of(const Eigen::Vector3d& ecef);
/// Columns: north, east, down in ecef.
Eigen::Matrix3d ecef_R_ned(double latitude, double longitude);
double meridian_radius(double latitude);        ///< M, m
double prime_vertical_radius(double latitude);  ///< N, m
/// Normal gravity at height, m/s^2: Somigliana closed form with the second-order height term (TR8350.2, 4-1 and 4-3).
double normal_gravity(double latitude, double height);

}  // namespace swath::core
