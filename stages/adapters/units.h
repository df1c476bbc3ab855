// SPDX-License-Identifier: GPL-3.0-or-later
// Metres of a run to the units of the products' CRS and back.
#pragma once

#include <utility>

#include "core/block.h"
#include "core/grid.h"
#include "core/grid_units.h"
#include "stages/stage.h"

namespace swath::stages {

inline core::Lattice in_crs_units(const Context& context, core::Lattice lattice) { return core::in_units(context.unit, lattice); }
inline core::Grid in_crs_units(const Context& context, core::Grid grid) {
  return core::in_units(context.unit, context.vertical_unit, std::move(grid));
}

/// Scales a Block's coordinates and origin: from metres to CRS units with `to_crs`, or back.
inline void scale_block(const Context& context, core::Block& block, bool to_crs) {
  const double h = to_crs ? 1.0 / context.unit : context.unit;
  const double v = to_crs ? 1.0 / context.vertical_unit : context.vertical_unit;
  if (h != 1.0) {
    for (double& x : block.x) x *= h;
    for (double& y : block.y) y *= h;
    block.origin.head<2>() *= h;
  }
  if (v != 1.0) {
    for (double& z : block.z) z *= v;
    block.origin.z() *= v;
  }
}

}  // namespace swath::stages
