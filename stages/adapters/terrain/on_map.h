// SPDX-License-Identifier: GPL-3.0-or-later
// From metres relative to the run's origin to coordinates of the products' CRS in its units.
#pragma once

#include <Eigen/Core>

#include "stages/stage.h"

namespace swath::stages {

struct OnMap {
  const Context& context;
  double height(double z) const { return (z + context.origin.z()) / context.vertical_unit; }
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
    return {(p.x() + context.origin.x()) / context.unit, (p.y() + context.origin.y()) / context.unit, height(p.z())};
  }
};

}  // namespace swath::stages
