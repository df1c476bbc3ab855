// SPDX-License-Identifier: GPL-3.0-or-later
// A building as it is found.
#pragma once

#include <limits>
#include <vector>

#include "terrain/buildings/outline.h"
#include "terrain/buildings/roof_planes.h"

namespace swath::terrain {

/// A piece of a roof on one plane, seen from above.
struct RoofFace {
  std::size_t plane = 0;
  Outline outline;
};

/// Heights relative to the origin, m; not a number where they are not known.
struct Building {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  Outline outline;
  bool squared = false;  ///< two directions at right angles were given to its sides
  bool is_cut = false;   ///< beside 3 m of its outline there is no return as far as 3 m more than its height
  double area = 0.0;     ///< m2, of the outline less its courtyards
  std::uint64_t returns = 0;
  double explained = 0.0;  ///< share of the roof's area that lies on its planes
  double on_lowest = 0.0;  ///< share of its returns within twice the tolerance of the lowest of its planes there; 0 of more than 12
  double lowest_ground = none, mean_ground = none;  ///< along the outline, 1 m outside of it
  double eaves = none;                              ///< of the planes along the outline: 10 % of it are lower
  double ridge = none;                              ///< of the highest place of the planes
  double middle = none;                             ///< median of the returns on planes (of all, where there is no plane)
  double top = none;                                ///< of the highest return
  std::vector<RoofPlane> planes;
  std::vector<RoofFace> faces;
};

}  // namespace swath::terrain
