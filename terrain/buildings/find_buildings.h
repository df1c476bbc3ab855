// SPDX-License-Identifier: GPL-3.0-or-later
// Buildings from their returns: outline, roof planes, heights.
#pragma once

#include <functional>
#include <vector>

#include "terrain/buildings/building.h"

namespace swath::terrain {

struct BuildingOptions {
  double gap = 2.0;              ///< m: returns of one roof are nearer to one another
  double least_area = 10.0;      ///< m2, of a building
  double least_courtyard = 8.0;  ///< m2; smaller holes are filled
  double movement = 1.0;         ///< m, of an outline's places
  bool square = true;
  RoofPlaneOptions planes{};
};

/// m, relative to the block's origin.
struct RoofReturn {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// What lies around buildings, at a place relative to the origin.
struct Surroundings3d {
  std::function<double(const Eigen::Vector2d&)> ground;     ///< height, m, relative to the origin; not a number where there is none
  std::function<bool(const Eigen::Vector2d&)> has_returns;  ///< of any kind, within a metre or two
};

struct FoundBuildings {
  std::vector<Building> buildings;  ///< by the least (x, y) of their outlines
  std::uint64_t small = 0;          ///< parts that are no building because of their area
  std::uint64_t small_returns = 0;  ///< returns in them
  std::uint64_t alone = 0;          ///< returns that are part of nothing
  std::uint64_t not_finite = 0;     ///< returns left out
};

/// By the least (x, y) of their outlines.
bool is_west_of(const Building& a, const Building& b);

/// The buildings of a set of returns that no others are nearer to than `gap`. A building is a part of their alpha shape: Delaunay triangles
/// with a circumradius of at most half the gap. Does not depend on the order of the returns. Of returns at one (x, y) the lowest counts.
FoundBuildings find_buildings(std::vector<RoofReturn> returns, const Surroundings3d& around, const BuildingOptions& o);

}  // namespace swath::terrain
