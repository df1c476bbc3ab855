// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

/// A roof facet or wall. Coordinates as World: metres east and north of the area's middle, absolute heights.
struct Facet {
  std::string name;                      ///< of the building with "roof 1" ..., "wall 1" ...
  bool roof = false;                     ///< false: a wall, upright
  Eigen::Vector3d normal;                ///< unit, outwards
  std::vector<Eigen::Vector3d> corners;  ///< counter-clockwise as seen from outside; a wall's lower corners lie on the ground
};

/// All facets of the world's buildings (not of masts), in their order.
std::vector<Facet> facets_of(const World& world);

/// truth/planes.csv: name, kind (roof, wall), normal (east, north, up), corners as "x y z;x y z;..." in map coordinates, m.
void write_planes(const std::filesystem::path& file, const std::vector<Facet>& facets, const MapPatch& map);

}  // namespace swath::simulate
