// SPDX-License-Identifier: GPL-3.0-or-later
// A plane through the weighted data around every cell of a raster.
#pragma once

#include <span>

#include "filters/ground/morphology.h"

namespace swath::filters {

/// Data summed by cell. All rasters are of one size; a cell without data holds zeros.
struct CellSums {
  Raster weight;  ///< sum of the weights
  Raster value;   ///< sum of weight times value
  Raster square;  ///< sum of weight times value squared
};

/// A plane per cell: value(dx, dy) = height + east dx + north dy, dx and dy in cells from the cell's centre.
struct PlaneField {
  Raster height, east, north;
  Raster support;   ///< data behind it: sum of weight times kernel
  Raster variance;  ///< weighted mean square of the data about the plane; 0 without data
};

/// Weighted least squares under a Gaussian kernel of standard deviation `sigma` cells, cut off at reach(sigma). `prior` data of value 0
/// with the cell's own centre as centroid, spread like the kernel, are added: with little data around, the plane tends to 0.
PlaneField fit_planes(const CellSums& data, double sigma, double prior);

/// Sums under the Gaussian.
Raster blur(const Raster& in, double sigma);

/// Cells from a cell to the farthest that its plane depends on.
int reach(double sigma);

/// Planes that stand for a cell when they lie `step` cells away.
struct PlaneChoice {
  const PlaneField& planes;
  int step = 1;
};

/// The planes' heights at their cells with the breaks kept: each cell takes the mean of its own planes and those `step` cells away to the
/// eight main directions, continued to the cell, of all fields, weighted by support / (variance + noise^2)^3.
/// Reach: `step` cells beyond the planes'.
Raster across_breaks(std::span<const PlaneChoice> fields, double noise);

}  // namespace swath::filters
