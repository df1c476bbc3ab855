// SPDX-License-Identifier: GPL-3.0-or-later
// Metres of a run to the units of the products' CRS.
#pragma once

#include <utility>

#include "core/grid_units.h"
#include "stages/stage.h"

namespace swath::stages {

inline core::Lattice in_crs_units(const Context& context, core::Lattice lattice) { return core::in_units(context.unit, lattice); }
inline core::Grid in_crs_units(const Context& context, core::Grid grid) {
  return core::in_units(context.unit, context.vertical_unit, std::move(grid));
}

/// Metres of one unit of the heights that PROJ gives in the run's CRS: of a CRS that states no unit these are metres, whatever the run's
/// heights count in.
inline double metres_per_transformed_height(const Context& context) { return context.crs.has_height_unit() ? context.vertical_unit : 1.0; }

/// Scales a Block's coordinates and origin from metres to CRS units.
inline void to_crs_units(const Context& context, core::Block& block) {
  core::scale_block(1.0 / context.unit, 1.0 / context.vertical_unit, block);
}

}  // namespace swath::stages
