// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration flight, after the use of flat targets: opposite lines along the target's long wall determine roll, opposite profiles pitch,
// lines that have the target at the swath's edge heading, a second height lever arm and range offset from the angles (docs/simulate.md).
#include "simulate/line_plan.h"

#include <algorithm>
#include <cmath>

namespace swath::simulate {
namespace {

using Eigen::Vector2d;

constexpr double sway = 2.0 * core::degree;  // what roll may take off the swath's edge while the target must stay in it
constexpr double least_edge = 0.5;           // share of the half swath

Vector2d along_course(double course) { return {std::cos(course), std::sin(course)}; }  // north, east

std::vector<LinePlan> block(const FlightOptions& flight, const WorldOptions& world, double half_angle, const Vector2d& along) {
  const int lines = flight.lines.value_or(3);
  const double swath = 2 * flight.height.value * std::tan(half_angle);
  const double spacing = swath * (1 - flight.overlap);
  const double length = flight.line_length ? flight.line_length->value : world.length.value;
  const Vector2d across(-along.y(), along.x());
  std::vector<LinePlan> plan;
  for (int i = 0; i < lines; ++i) {
    const Vector2d middle = (i - 0.5 * (lines - 1)) * spacing * across;
    const double sense = i % 2 ? -1.0 : 1.0;
    plan.push_back({middle - sense * 0.5 * length * along, middle + sense * 0.5 * length * along, "line " + std::to_string(i + 1)});
  }
  const double reach = (lines - 1) * spacing + swath;
  for (int i = 0; i < flight.cross_lines; ++i) {
    const Vector2d middle = length * ((i + 0.5) / flight.cross_lines - 0.5) * along;
    const double sense = i % 2 ? -1.0 : 1.0;
    plan.push_back({middle - sense * 0.5 * reach * across, middle + sense * 0.5 * reach * across, "cross line " + std::to_string(i + 1)});
  }
  return plan;
}

std::vector<LinePlan> calibration(const FlightOptions& flight, const WorldOptions& world, double half_angle, const Vector2d& along) {
  const Vector2d across(-along.y(), along.x());
  const double height = flight.height.value, upper = flight.upper_height();
  const double length = flight.line_length ? flight.line_length->value : std::max(world.length.value, world.width.value) + 0.7 * height;
  std::vector<LinePlan> plan;
  // Line `i` of a group, counted from 0, `aside` metres to the right of the area's middle as the first one flies.
  const auto add = [&](const std::string& name, int i, const Vector2d& way, const Vector2d& middle, double level, bool scans) {
    const double sense = flight.opposite && i % 2 ? -1.0 : 1.0;
    plan.push_back(
        {middle - sense * 0.5 * length * way, middle + sense * 0.5 * length * way, name + " " + std::to_string(i + 1), level, scans});
  };
  // Along and across by turns: the way from one to the other is half of that back onto the same line.
  const auto centre = [&](const std::string& high, double level) {
    for (int i = 0; i < std::max(2, flight.cross_lines); ++i) {
      if (i < 2) add(high + "along", i, along, Vector2d::Zero(), level, true);
      if (i < flight.cross_lines) add(high + "across", i, across, Vector2d::Zero(), level, true);
    }
  };
  centre("", 0.0);
  if (flight.edge_lines) {
    const double half_swath = height * std::tan(half_angle);
    const double aside = std::max(least_edge * half_swath, height * std::tan(half_angle - sway) - airfield_building(world).half_width);
    // Flown against each other both have the middle on their right; in one direction the second has it on its left.
    add("edge right", 0, along, -aside * across, 0.0, true);
    add(flight.opposite ? "edge right" : "edge left", 1, along, aside * across, 0.0, true);
  }
  if (flight.profile_lines)
    for (int i = 0; i < 2; ++i) add("profile", i, along, Vector2d::Zero(), 0.0, false);
  if (upper > 0.0) centre("high ", upper - height);
  if (flight.lines && static_cast<size_t>(*flight.lines) < plan.size()) plan.resize(static_cast<size_t>(*flight.lines));
  return plan;
}

}  // namespace

std::vector<LinePlan> plan_lines(const FlightOptions& flight, const WorldOptions& world, double half_angle, double convergence) {
  const Vector2d along = along_course(flight.direction.value + convergence);
  return flight.pattern == FlightPattern::calibration ? calibration(flight, world, half_angle, along)
                                                      : block(flight, world, half_angle, along);
}

}  // namespace swath::simulate
