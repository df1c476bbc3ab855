// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_set.h"

#include <Eigen/Geometry>

namespace swath::calib {

using Eigen::Vector3d;

std::string_view name_of(TieKind kind) {
  switch (kind) {
    case TieKind::ground:
      return "ground";
    case TieKind::roof:
      return "roof";
    case TieKind::wall:
      return "wall";
    case TieKind::target:
      return "target";
  }
  return "";
}

std::array<Vector3d, 2> plane_axes(const Vector3d& normal) {
  // A level plane has no level line of its own: u is east turned into the plane.
  constexpr double level = 1e-6;
  const double across = normal.head<2>().norm();
  const Vector3d u = across > level ? Vector3d(-normal.y() / across, normal.x() / across, 0.0)
                                    : Vector3d(Vector3d::UnitX() - normal.x() * normal).normalized();
  return {u, normal.cross(u).normalized()};
}

}  // namespace swath::calib
