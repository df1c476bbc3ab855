// SPDX-License-Identifier: GPL-3.0-or-later
// What a laser scanner delivers from a height: footprint, swath, spacing, density, and the photogrammetry that a client compares it with.
// Source: Brandalize, airborne laser profiling, equations (1) to (4), (12) to (14), tables 02, 07 and 08. Equation (13) is printed with a
// wrong factor: it is 0.0005. Table 02 was computed with 125 knots and rounded swaths. Angles in rad, lengths in m, frequencies in Hz.
#pragma once

#include <cmath>

namespace swath::planning {

inline constexpr double speed_of_light = 299792458.0;  ///< m/s; the air's index (3e-4) is left out

/// Diameter of the beam's footprint from height `height` with the full divergence `divergence`, m (1).
inline double footprint(double divergence, double height) { return divergence * height; }

/// Time of a pulse to the ground and back, s (2).
inline double time_of_flight(double height) { return 2.0 * height / speed_of_light; }

/// Width of the swath, m; `half_angle` below 90 deg (3).
inline double swath_width(double height, double half_angle) { return 2.0 * height * std::tan(half_angle); }
/// The height that gives this width, m: (3) solved for H.
inline double height_of_swath(double width, double half_angle) { return width / (2.0 * std::tan(half_angle)); }

/// Mean spacing of pulses across the track of an oscillating mirror, m; `scans`: full scans, there and back, per second (4).
inline double spacing_across(double scans, double width, double pulses) { return 2.0 * scans * width / pulses; }

/// Mean spacing of scan lines along the track of an oscillating mirror, m: two lines to a full scan.
inline double spacing_along(double speed, double scans) { return speed / (2.0 * scans); }

/// Pulses per square metre of one swath, mean over its width.
inline double density(double pulses, double speed, double width) { return pulses / (speed * width); }

/// Spacing on the ground of pulses of which a share `penetration` (above 0, at most 1) reaches it, m: 1.4 m becomes 3.13 m at 20 %.
inline double penetrated_spacing(double spacing, double penetration) { return spacing / std::sqrt(penetration); }

/// Accuracy of a photogrammetric plot as shares of the flying height: planimetry (12) and height (13).
inline constexpr double photo_planimetry = 0.325 / 750.0, photo_height = 0.0005;

/// Contour interval that a photogrammetric instrument of C factor `c_factor` carries from height `height`, m (14); and the reverse.
inline double interval_of(double height, double c_factor) { return height / c_factor; }
inline double c_factor_of(double height, double interval) { return height / interval; }

/// Resolution of a scanned photograph, line pairs per mm: that of the film (line pairs per mm) and that of a scanner of that pixel (um)
/// as independent losses (table 07).
inline double scanned_resolution(double film, double pixel) { return 1.0 / std::hypot(1.0 / film, pixel / 1000.0); }

}  // namespace swath::planning
