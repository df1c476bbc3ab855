// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration flight over a flat target: opposite lines along the target's long wall determine roll, opposite profiles pitch, lines that
// have the target at the swath's edge heading, a second height lever arm and range offset from the angles (docs/simulate.md).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace swath::planning {

struct CalibrationFlight {
  double height = 0.0, second_height = 0.0;  ///< m above the target; second 0: none
  double half_angle = 0.0;                   ///< rad; a profiler's is taken as some small angle
  double length = 0.0;                       ///< of a line, m
  double target_half_width = 0.0;            ///< m across the first line
  int cross_lines = 2;                       ///< across the target, at each height
  bool edge_lines = true, profile_lines = true;
  bool opposite = true;  ///< the second line of each pair is flown against the first
};

/// Coordinates from the target's middle: x along the first line, y to its right; m.
struct CalibrationLine {
  Eigen::Vector2d from, to;
  std::string name;    ///< its part: "along 1", "across 2", "edge right 1" (the target lies at the swath's right edge), "high along 1"
  double level = 0.0;  ///< m above the first height
  bool scans = true;   ///< false: the mirror stands still at nadir
};
std::vector<CalibrationLine> calibration_lines(const CalibrationFlight& flight);

}  // namespace swath::planning
