// SPDX-License-Identifier: GPL-3.0-or-later
// Filling holes of a raster from their surroundings, with a bounded reach.
#pragma once

#include "filters/ground/morphology.h"

namespace swath::filters {

struct Inpainting {
  int reach = 10;           ///< cells: values farther away along a line have no influence
  int relax = 4;            ///< passes that smooth the filled cells, one more cell of reach each
  bool extrapolate = true;  ///< also cells that no line runs through from value to value

  int support() const { return reach + relax; }  ///< cells
};

/// Gives cells without value one, from the nearest values along the eight main directions. A line with values on both sides gives its
/// linear interpolation (planes come back exactly); where no line has both, and `extrapolate`, the mean of the single ends weighted
/// by the inverse square of the distance. Cells with nothing within reach stay NaN. Cells with a value keep it.
Raster inpaint(const Raster& surface, const Inpainting& how);

}  // namespace swath::filters
