// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::core {

/// The same cells with their side in units of the CRS, `unit` metres each; a cell of "3 ft" is 3 exactly again.
inline Lattice in_units(double unit, Lattice lattice) {
  if (unit != 1.0) lattice.cell = std::round(lattice.cell / unit * 1e9) / 1e9;
  return lattice;
}

/// The same grid with cell, heights and sigmas in such units.
inline Grid in_units(double unit, double vertical_unit, Grid grid) {
  grid.lattice = in_units(unit, grid.lattice);
  if (vertical_unit != 1.0) {
    for (float& h : grid.height) h = static_cast<float>(static_cast<double>(h) / vertical_unit);
    for (float& s : grid.sigma) s = static_cast<float>(static_cast<double>(s) / vertical_unit);
  }
  return grid;
}

/// Multiplies a block's coordinates, not its origin.
inline void scale_columns(double horizontal, double vertical, Block& block) {
  const auto scale = [](std::vector<double>& column, double factor) {
    if (factor != 1.0)
      for (double& v : column) v *= factor;
  };
  scale(block.x, horizontal);
  scale(block.y, horizontal);
  scale(block.z, vertical);
}

/// Multiplies its origin, too.
inline void scale_block(double horizontal, double vertical, Block& block) {
  scale_columns(horizontal, vertical, block);
  block.origin = block.origin.cwiseProduct(Eigen::Vector3d(horizontal, horizontal, vertical));
}

}  // namespace swath::core
