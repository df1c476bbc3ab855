// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geo/crs.h"
#include "simulate/flight.h"
#include "simulate/flight_options.h"
#include "simulate/scene_options.h"

namespace swath::simulate {

/// A line to fly in the local plane (true north, east; m).
struct LinePlan {
  Eigen::Vector2d from, to;
  std::string name;
  double level = 0.0;  ///< m above the flight's own height
  bool scans = true;   ///< false: the mirror stands still at nadir
};

/// The lines of the options about the area's middle, in the order of flight. `convergence`: bearing of grid north from true north, rad.
/// The names of a calibration flight's lines state their part: "along 1", "across 2", "edge right 1" (the middle lies at the swath's right
/// edge), "profile 1", "high along 1".
std::vector<LinePlan> plan_lines(const FlightOptions& flight, const WorldOptions& world, double half_angle, double convergence);

/// Lines that are given on the map, in a plane whose level 0 lies `flown` m high. Throws core::Error where a line is too short, or lies
/// beyond the CRS.
std::vector<LinePlan> given_lines(const std::vector<LineOptions>& lines, const core::Crs& crs, const LocalPlane& plane, double flown);

}  // namespace swath::simulate
