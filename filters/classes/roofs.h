// SPDX-License-Identifier: GPL-3.0-or-later
// Roofs: cells of planes off the ground that are high enough and connected over enough area.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/classes/structure_cells.h"

namespace swath::filters {

struct RoofLimits {
  double height = 2.0;  ///< m above ground
  double side = 3.0;    ///< m: side of the square whose area a roof covers at least
};

/// Metres of cells around a place that roof_cells depends on there.
double roof_cells_halo(double side);
/// Of these, how far from a cell with a roof the wide planes may lie with which the roof begins.
double roof_spread();

/// Height of the roof (m, as in `cells`) for every cell of a roof; NaN elsewhere. Wide planes in enough cells make a roof; then the wide
/// ones that it goes on with at its level down to three quarters of the least height, the smaller planes beside it on its level, and the
/// cells with returns off the ground (`standing`) that have roofs nearly all around. Cells of `decks` are left out, and what stands alone
/// and is up to 2.6 m wide: vehicles, containers, clipped hedges. Roofs
/// that begin in no cell that `begun` touches are not looked for.
std::vector<float> roof_cells(const StructureCells& cells, const std::vector<std::uint8_t>& standing,
                              const std::vector<std::uint8_t>& decks, const Districts& where, const RoofLimits& limits,
                              const OwnBox& begun);

}  // namespace swath::filters
