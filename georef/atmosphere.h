// SPDX-License-Identifier: GPL-3.0-or-later
// What the air does to a laser pulse: it slows it (range) and bends it (refraction).
#pragma once

#include <Eigen/Core>

#include "core/records/sensor.h"

namespace swath::georef {

/// Index of refraction of moist air, CO2 450 ppm (Ciddor 1996). Wavelength in vacuum, m: 300 to 1700 nm. Valid from -40 to 100 degC,
/// 80 to 120 kPa at 2-5e-8; usable to 30 kPa at 1e-7.
double phase_index(const core::Air& air, double wavelength);
/// Group index n_g = n - wavelength dn/dwavelength (Ciddor & Hill 1999): the one that ranges follow.
double group_index(const core::Air& air, double wavelength);

/// Mean of n - 1 along a path from a place with n0 to one with n1, n - 1 falling exponentially with height: (N0 - N1) / ln(N0 / N1).
/// The mean over height is the mean over a slanted straight path too.
double mean_refractivity(double refractivity_sensor, double refractivity_ground);

/// The air between the scanner and the ground, as two numbers.
struct AirPath {
  double range_factor = 1.0;  ///< true range = recorded range * range_factor: group index already in the record / mean group index
  double bending = 0.0;  ///< mean phase index of the path / that at the scanner - 1: deflection to the nadir = bending * tan(off-nadir)
};
AirPath air_path(const core::Scanner& scanner);

/// The straight vector from the scanner to the point that a bent ray of the same length reaches (flat layers, Snell: n sin z = constant).
/// `ray`: range times the beam's direction at the scanner, m; `down`: unit vector to the nadir, same frame.
/// Size at bending 1.4e-5 (1000 m of standard atmosphere): 5 mm at 20 deg and 9 mm at 30 deg off nadir from 1000 m; nine times as much
/// from 3000 m (5 and 8 cm). Beams more than 84 deg off nadir are bent as at 84 deg.
Eigen::Vector3d refract(const Eigen::Vector3d& ray, const Eigen::Vector3d& down, double bending);
/// Its derivative with respect to `ray`.
Eigen::Matrix3d refract_jacobian(const Eigen::Vector3d& ray, const Eigen::Vector3d& down, double bending);

}  // namespace swath::georef
