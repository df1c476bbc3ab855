// SPDX-License-Identifier: GPL-3.0-or-later
// What planned lines deliver, cell by cell: pulses per m2, lines that see the cell, sigma of a point.
#pragma once

#include <vector>

#include "core/grid.h"
#include "core/height_field.h"
#include "planning/layout.h"
#include "planning/plan_options.h"

namespace swath::planning {

/// The sensor and its motion as numbers.
struct Beam {
  ScanPattern pattern = ScanPattern::triangle;
  double prf = 0.0, speed = 0.0, half_angle = 0.0;  ///< 1/s, m/s, rad
  double max_range = 0.0;                           ///< m; 0: any
};

/// Row-major from the south-west; NaN outside of the area.
struct Coverage {
  core::Lattice lattice;
  std::vector<float> density;           ///< pulses per m2 of the map, of all lines
  std::vector<float> lines;             ///< lines that see the cell, by share of its area: 1.4 is one and 40 % of another
  std::vector<float> sigma_height;      ///< m, of the surface's height by one point; NaN where no line sees the cell
  std::vector<float> sigma_horizontal;  ///< m, radial
};

/// Lines are straight and level, without roll, pitch and crab. Ground behind a ridge is not seen. The density is that of the map: pulses
/// that meet a slope from below lie closer.
Coverage coverage_of(const std::vector<FlightLine>& lines, const std::vector<Ring>& area, const core::HeightField& ground, const Beam& beam,
                     const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double cell);

}  // namespace swath::planning
