// SPDX-License-Identifier: GPL-3.0-or-later
// Metres of a run to the units of the products' CRS and back.
#pragma once

#include "core/block.h"
#include "core/grid.h"
#include "stages/stage.h"

namespace swath::stages {

/// The same cells with their side in units of the CRS; a cell of "3 ft" is 3 exactly again.
inline core::Lattice in_crs_units(const Context& context, core::Lattice lattice) {
  if (context.unit != 1.0) lattice.cell = std::round(lattice.cell / context.unit * 1e9) / 1e9;
  return lattice;
}

/// The same grid with cell, heights and sigmas in the units of the CRS.
inline core::Grid in_crs_units(const Context& context, core::Grid grid) {
  grid.lattice = in_crs_units(context, grid.lattice);
  if (context.vertical_unit != 1.0) {
    for (float& h : grid.height) h = static_cast<float>(static_cast<double>(h) / context.vertical_unit);
    for (float& s : grid.sigma) s = static_cast<float>(static_cast<double>(s) / context.vertical_unit);
  }
  return grid;
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
