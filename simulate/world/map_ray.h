// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>

#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

/// A straight line through the air as the map shows it.
struct MapRay {
  Ray ray;
  double begin = 0.0;   ///< m along the line where the ray starts, above the highest ground
  double length = 0.0;  ///< m from there to below the lowest ground
};

/// `tangent`, `slope`: the line's start and unit direction in the map's tangent frame. Nothing where it hardly comes down.
std::optional<MapRay> ray_down(const MapPatch& map, const Relief& relief, const Eigen::Vector3d& tangent, const Eigen::Vector3d& slope);

}  // namespace swath::simulate
