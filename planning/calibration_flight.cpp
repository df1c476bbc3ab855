// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/calibration_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr double sway = 2.0 * std::numbers::pi / 180.0;  // what roll may take off the swath's edge while the target must stay in it
constexpr double least_edge = 0.5;                       // share of the half swath

}  // namespace

std::vector<CalibrationLine> calibration_lines(const CalibrationFlight& f) {
  const Vector2d along = Vector2d::UnitX(), across = Vector2d::UnitY();
  std::vector<CalibrationLine> out;
  // Line `i` of a group, counted from 0, `aside` metres to the right of the target's middle as the first one flies.
  const auto add = [&](const std::string& name, int i, const Vector2d& way, const Vector2d& middle, double level, bool scans) {
    const double sense = f.opposite && i % 2 ? -1.0 : 1.0;
    out.push_back(
        {middle - sense * 0.5 * f.length * way, middle + sense * 0.5 * f.length * way, name + " " + std::to_string(i + 1), level, scans});
  };
  // Along and across by turns: the way from one to the other is half of that back onto the same line.
  const auto centre = [&](const std::string& high, double level) {
    for (int i = 0; i < std::max(2, f.cross_lines); ++i) {
      if (i < 2) add(high + "along", i, along, Vector2d::Zero(), level, true);
      if (i < f.cross_lines) add(high + "across", i, across, Vector2d::Zero(), level, true);
    }
  };
  centre("", 0.0);
  if (f.edge_lines) {
    const double half_swath = f.height * std::tan(f.half_angle);
    const double aside = std::max(least_edge * half_swath, f.height * std::tan(f.half_angle - sway) - f.target_half_width);
    // Flown against each other both have the middle on their right; in one direction the second has it on its left.
    add("edge right", 0, along, -aside * across, 0.0, true);
    add(f.opposite ? "edge right" : "edge left", 1, along, aside * across, 0.0, true);
  }
  if (f.profile_lines)
    for (int i = 0; i < 2; ++i) add("profile", i, along, Vector2d::Zero(), 0.0, false);
  if (f.second_height > 0.0) centre("high ", f.second_height - f.height);
  return out;
}

}  // namespace swath::planning
