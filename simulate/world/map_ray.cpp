// SPDX-License-Identifier: GPL-3.0-or-later
// The line on the map is a parabola through three of its points between the highest and the lowest ground.
#include "simulate/world/map_ray.h"

#include <algorithm>

namespace swath::simulate {

using Eigen::Vector3d;

std::optional<MapRay> ray_down(const MapPatch& map, const Relief& relief, const Vector3d& tangent, const Vector3d& slope) {
  if (slope.z() > -0.1) return {};
  MapRay out;
  const double top = map.map_of(tangent).z();
  out.begin = std::max(0.0, (top - relief.highest() - 1.0) / -slope.z());
  const double end = std::max(out.begin + 10.0, (top - relief.lowest() + 1.0) / -slope.z());
  const double half = 0.5 * (end - out.begin);
  const Vector3d a = map.map_of(tangent + out.begin * slope), b = map.map_of(tangent + (out.begin + half) * slope),
                 c = map.map_of(tangent + end * slope);
  out.ray = {a, (4 * b - 3 * a - c) / (2 * half), (a - 2 * b + c) / (2 * half * half)};
  out.length = end - out.begin;
  return out;
}

}  // namespace swath::simulate
