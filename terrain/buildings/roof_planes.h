// SPDX-License-Identifier: GPL-3.0-or-later
// Planes of a roof.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "terrain/buildings/outline.h"

namespace swath::terrain {

struct RoofPlaneOptions {
  double tolerance = 0.15;  ///< m, at right angles: returns within it lie on the plane
  double least_area = 4.0;  ///< m2 in plan, of a plane
};

/// z = level + slope . ((x, y) - at).
struct RoofPlane {
  Eigen::Vector2d at = Eigen::Vector2d::Zero(), slope = Eigen::Vector2d::Zero();
  double level = 0.0;
  double rms = 0.0;           ///< m, at right angles, of its returns
  std::uint64_t returns = 0;  ///< that lie on it
  double area = 0.0;          ///< m2 in plan, of its triangles

  double height(const Eigen::Vector2d& p) const { return level + slope.dot(p - at); }
  double inclination() const { return std::atan(slope.norm()); }  ///< rad
  double aspect() const;                                          ///< rad clockwise from north, downhill; not a number where it is level
};

struct RoofPlanes {
  std::vector<RoofPlane> planes;    ///< the largest first
  std::vector<std::int32_t> plane;  ///< of each of the TIN's vertices; -1: none
};

/// Planes among the vertices of a part of a TIN, found by growth along its edges from where the surroundings are flattest. Steeper ones
/// than 75 deg are not looked for. Depends on the TIN alone.
RoofPlanes roof_planes(const Tin& tin, const TrianglePart& part, const RoofPlaneOptions& o);

/// The plane that at least two of a triangle's vertices lie on; -1: none.
std::int32_t plane_of(const Tin& tin, std::int32_t triangle, const RoofPlanes& planes);

}  // namespace swath::terrain
