// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/line_plan.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "planning/calibration_flight.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;

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
  planning::CalibrationFlight task;
  task.height = flight.height.value;
  task.second_height = flight.upper_height();
  task.half_angle = half_angle;
  task.length =
      flight.line_length ? flight.line_length->value : std::max(world.length.value, world.width.value) + 0.7 * flight.height.value;
  task.target_half_width = airfield_building(world).half_width;
  task.cross_lines = flight.cross_lines;
  task.edge_lines = flight.edge_lines;
  task.profile_lines = flight.profile_lines;
  task.opposite = flight.opposite;
  const Vector2d across(-along.y(), along.x());
  std::vector<LinePlan> plan;
  for (const planning::CalibrationLine& l : planning::calibration_lines(task)) {
    const auto place = [&](const Vector2d& p) -> Vector2d { return p.x() * along + p.y() * across; };
    plan.push_back({place(l.from), place(l.to), l.name, l.level, l.scans});
  }
  if (flight.lines && static_cast<size_t>(*flight.lines) < plan.size()) plan.resize(static_cast<size_t>(*flight.lines));
  return plan;
}

}  // namespace

std::vector<LinePlan> given_lines(const std::vector<LineOptions>& lines, const core::Crs& crs, const LocalPlane& plane, double flown) {
  const core::Transform to_geodetic(crs, core::wgs84_geodetic());
  std::vector<LinePlan> plan;
  for (const LineOptions& l : lines) {
    const auto place = [&](const std::array<core::Metres, 2>& map) -> Vector2d {
      const Eigen::Vector3d g = to_geodetic({map[0].value, map[1].value, l.height.value});
      return plane.plane_of({g.y() * core::degree, g.x() * core::degree, l.height.value}).head<2>();
    };
    const std::string name = l.name.empty() ? "line " + std::to_string(plan.size() + 1) : l.name;
    plan.push_back({place(l.from), place(l.to), name, l.height.value - flown, l.scans});
    if ((plan.back().to - plan.back().from).norm() < 1.0)
      throw core::usage_error(name + " is shorter than 1 m", "flight.line", "give another start or end");
  }
  return plan;
}

std::vector<LinePlan> plan_lines(const FlightOptions& flight, const WorldOptions& world, double half_angle, double convergence) {
  const Vector2d along = along_course(flight.direction.value + convergence);
  return flight.pattern == FlightPattern::calibration ? calibration(flight, world, half_angle, along)
                                                      : block(flight, world, half_angle, along);
}

}  // namespace swath::simulate
