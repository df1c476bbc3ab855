// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of height differences: blue below zero, white at zero, red above.
#pragma once

#include <string>

#include "core/grid.h"
#include "core/picture.h"
#include "report/canvas.h"

namespace swath::report {

struct DifferenceMapOptions {
  std::string title;       ///< UTF-8; empty: none
  std::string unit = "m";  ///< of the horizontal axes, as the scale bar names it
  double range = 0.0;      ///< m: full colour from here on, both ways; 0: difference_range() of the grid
  int max_side = 1000;     ///< of the map, pixels
};

/// A round number (1, 2 or 5 times a power of ten, from 1 mm on) that 98 % of the differences do not exceed, m. Without any: 1 mm.
double difference_range(const core::Grid& grid);

/// A map of height differences (Grid::height, m), north up: the palette around zero over a range that the legend states in cm (m from 1 m
/// on), with the share of cells beyond it; cells without a difference hatched in grey; title, scale bar, north arrow. A grid larger than
/// max_side is averaged by whole blocks, a small one enlarged, as in report/picture.h. An empty grid gives an empty drawing.
Drawing difference_map(const core::Grid& grid, const DifferenceMapOptions& options = {});

/// Blue at -1, white at 0, red at 1; beyond as at the ends.
core::Rgb diverging_colour(double t);

}  // namespace swath::report
