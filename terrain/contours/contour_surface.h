// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/grid.h"

namespace swath::terrain {

/// The surface that contours are traced on: the grid's heights without their unevenness over some few cells, each within
/// `contour_surface_share` of the vertical tolerance (m) of its own. One surface for all levels, so their lines neither meet nor change
/// their order. Planes stay planes up to the rim of the data, level water stays level, voids stay void. A height depends on those within
/// contour_surface_reach() cells of it and not on where the grid begins. Tolerance 0 leaves everything as it is.
core::Grid contour_surface(core::Grid grid, double tolerance);

/// Cells around a cell that its height depends on.
int contour_surface_reach(double tolerance);

constexpr double contour_surface_share = 0.8;  ///< the rest is for the thinning of the lines

}  // namespace swath::terrain
