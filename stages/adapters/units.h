// SPDX-License-Identifier: GPL-3.0-or-later
// Metres of a run to the units of the products' CRS and back.
#pragma once

#include <cmath>
#include <utility>

#include "core/block.h"
#include "core/grid.h"
#include "stages/stage.h"

namespace swath::stages {

/// The same cells with their side in units of the CRS, `unit` metres each; a cell of "3 ft" is 3 exactly again.
inline core::Lattice in_units(double unit, core::Lattice lattice) {
  if (unit != 1.0) lattice.cell = std::round(lattice.cell / unit * 1e9) / 1e9;
  return lattice;
}

/// The same grid with cell, heights and sigmas in such units.
inline core::Grid in_units(double unit, double vertical_unit, core::Grid grid) {
  grid.lattice = in_units(unit, grid.lattice);
  if (vertical_unit != 1.0) {
    for (float& h : grid.height) h = static_cast<float>(static_cast<double>(h) / vertical_unit);
    for (float& s : grid.sigma) s = static_cast<float>(static_cast<double>(s) / vertical_unit);
  }
  return grid;
}

inline core::Lattice in_crs_units(const Context& context, core::Lattice lattice) { return in_units(context.unit, lattice); }
inline core::Grid in_crs_units(const Context& context, core::Grid grid) {
  return in_units(context.unit, context.vertical_unit, std::move(grid));
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
