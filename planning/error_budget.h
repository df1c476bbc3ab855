// SPDX-License-Identifier: GPL-3.0-or-later
// The error of a laser point by its sources, before a flight: Brandalize, table 10. It is the linear part of the equation of a point
// (georef/shot_geometry.h), which test compares it with; refraction and the curvature of the Earth are left out (below 1e-6 of an error).
// One of the table's 108 cells is misprinted: 31 for 30 (heading, X at 20 deg, 1200 m).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "core/config/option.h"
#include "core/records/sensor.h"

namespace swath::planning {

/// Errors of what a point is computed from: sigmas, or systematic errors with their signs. Position: along track, across, up.
struct ErrorSources {
  double roll = 0.0, pitch = 0.0, heading = 0.0;  ///< rad, of trajectory and boresight
  double scan_angle = 0.0;                        ///< rad
  double range = 0.0;                             ///< m
  double along = 0.0, across = 0.0, up = 0.0;     ///< m, of the scanner's place
};

inline constexpr std::array<std::string_view, 8> source_names{"roll", "pitch", "heading", "scan angle", "range", "along", "across", "up"};

struct ErrorBudget {
  std::array<Eigen::Vector3d, 8> by_source{};  ///< m: along track, across, up; in the order of source_names, with the sources' signs
  Eigen::Vector3d total() const;               ///< root of the sum of squares, m
};

/// Of a point `height` metres below the scanner at scan angle `angle` (rad, positive to starboard, below 90 deg). X is along the track, Z
/// up, Y completes them to the left; the table's point lies at -20 deg.
ErrorBudget error_budget(const ErrorSources& sources, double height, double angle);

/// Sigma of the surface's height at the point, m, where the ground rises by `slope_along` and `slope_across` (rise / run; across: towards
/// Y): what a horizontal error does to the height of a slope is added source by source.
double surface_sigma(const ErrorBudget& budget, double slope_along, double slope_across);

/// The sources of a survey as its [sigma] and its trajectory state them.
struct TrajectorySigma {
  core::Metres horizontal{0.02}, vertical{0.03};
  core::Radians roll_pitch = core::degrees(0.0025), heading = core::degrees(0.005);
};
/// `speed`, m/s: what an error of time moves a point along the track.
ErrorSources sources_of(const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double height, double angle, double speed);

/// Sigma of terrain heights under forest, m, (15): 10 + 120 tan(slope) cm. None where less than a quarter of the pulses reach the ground,
/// which the equation is not for. `slope` in rad, below 90 deg.
std::optional<double> forest_sigma(double slope, double penetration);

/// What is left of a sigma once the reference's own is taken out (16): the root of a difference of squares. Negative: the root of the
/// opposite difference with a minus sign, where the reference's sigma is the larger one and explains all of it.
double without_reference(double sigma, double reference);

}  // namespace swath::planning
