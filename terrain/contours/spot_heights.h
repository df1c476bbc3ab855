// SPDX-License-Identifier: GPL-3.0-or-later
// Tops and pits of a height grid, for spot heights on a map.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "core/config/option.h"
#include "core/grid.h"

namespace swath::terrain {

struct SpotOptions {
  core::Metres radius{50.0};
  core::Metres relief{0.5};
};

template <class V>
void describe(SpotOptions& o, V& v) {
  v.option("radius", o.radius, core::at_least(0.0),
           "A top is the highest cell within this radius, a pit the lowest; 0 for no spot heights.");
  v.option("relief", o.relief, core::at_least(0.0), "Minimum height of a top above the mean ground within the radius, and depth of a pit.");
}

/// A cell's height at its centre. Plain data without padding: may be written to a file as it is.
struct SpotHeight {
  std::int64_t j = 0, i = 0;  ///< cell of the survey's lattice
  double height = 0.0;        ///< m
  std::int64_t top = 0;       ///< 1 top, 0 pit
  auto operator<=>(const SpotHeight&) const = default;
};

/// Metres of grid around a window that the result depends on.
double halo(const SpotOptions& o);

/// Tops and pits among the cells of `own`, in the order of rows from the south. `grid` must reach halo() beyond own where the survey goes
/// on. All eight neighbours of a top or pit are known, so the edge of the survey or of a void makes none. Of equal heights within the
/// radius the south-westernmost row, then column, counts.
std::vector<SpotHeight> spot_heights(const core::Grid& grid, const core::Lattice& own, const SpotOptions& options);

}  // namespace swath::terrain
