// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/tie_set.h"

#include <Eigen/Geometry>
#include <cmath>

namespace swath::calib {

std::string_view name_of(TieKind kind) {
  switch (kind) {
    case TieKind::ground:
      return "ground";
    case TieKind::roof:
      return "roof";
    case TieKind::wall:
      return "wall";
    default:
      return "target";
  }
}

std::array<Eigen::Vector3d, 2> plane_axes(const Eigen::Vector3d& normal) {
  const double level = std::hypot(normal.x(), normal.y());
  const Eigen::Vector3d u = level < 1e-9 ? Eigen::Vector3d(1.0, 0.0, 0.0) : Eigen::Vector3d(-normal.y() / level, normal.x() / level, 0.0);
  return {u, normal.cross(u)};
}

}  // namespace swath::calib
