// SPDX-License-Identifier: GPL-3.0-or-later
// The ground of a sample beside surveyed heights.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/geometry/geometry_fit.h"

namespace swath::calib {

/// Fewer surveyed points may each be wrong by themselves: nothing is judged by them.
constexpr size_t fewest_control_points = 3;

/// How far the ground lies from control.
struct ControlFigures {
  size_t points = 0, near = 0;  ///< surveyed, and within reach of a track
  double nearest = 0.0;         ///< m, from a track
  size_t compared = 0;
  double median = 0.0;                 ///< ground less control, m
  double spread = 0.0;                 ///< about that, robust, m
  double predicted = 0.0;              ///< what the sigmas make one expect, m
  double ground = 0.0, control = 0.0;  ///< median ellipsoidal heights, m
};

ControlFigures compare_control(const SampledFlight& flight, const LineCells& cells, const Chain& chain, const trajectory::Trajectory& t);

/// Held where the median is within `ratio` predicted sigmas or `tolerance`; nothing with too few points.
std::optional<GeometryCheck> check_control(const ControlFigures& figures, double ratio, double tolerance);

/// What a difference common to all points is by its size: heights above a geoid, or in feet. `undulation`: of the geoid there, m, NaN where
/// it is not known. `range`: from the ground to the trajectory, m.
struct HeightMistake {
  std::string name, what, cure;
};
std::optional<HeightMistake> height_mistake(const ControlFigures& figures, double undulation, double range,
                                            bool control_over_geoid = false);

}  // namespace swath::calib
