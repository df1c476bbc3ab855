// SPDX-License-Identifier: GPL-3.0-or-later
// Contours of a height grid by marching squares, tile by tile; terrain/contour_lines.h joins them.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "core/grid.h"
#include "core/option.h"

namespace swath::terrain {

struct ContourOptions {
  core::Metres interval{1.0};
  core::Metres base{0.0};
  int index = 5;
  core::Metres tolerance{0.1};
  core::Metres min_length{0.0};
};

template <class V>
void describe(ContourOptions& o, V& v) {
  v.option("interval", o.interval, core::above(0.0), "Height between contours.");
  v.option("base", o.base, "Height from which levels are counted.");
  v.option("index", o.index, core::at_least(0), "Every so many levels is an index contour; 0 for none.");
  v.option("tolerance", o.tolerance, core::at_least(0.0), "Farthest that simplification moves a line; 0 keeps every vertex.");
  v.option("min_length", o.min_length, core::at_least(0.0), "Lines shorter than this are left out.");
}

/// Height of a level, m.
inline double level_height(const ContourOptions& o, std::int64_t level) {
  return o.base.value + static_cast<double>(level) * o.interval.value;
}
inline bool is_index(const ContourOptions& o, std::int64_t level) { return o.index > 0 && level % o.index == 0; }

/// The lattice edge on which a contour vertex lies: from the centre of cell (i, j) of the survey's lattice to that of its eastern
/// (axis 0) or northern (axis 1) neighbour. The name by which segments find each other across tiles.
struct EdgeKey {
  std::int64_t i = 0, j = 0, axis = 0;
  auto operator<=>(const EdgeKey&) const = default;
};

/// One piece of one contour inside one square of four cell centres, directed with the higher ground on its left. Plain data without
/// padding: may be written to a file as it is.
struct Segment {
  std::int64_t level = 0;
  EdgeKey from, to;
  double from_x = 0.0, from_y = 0.0, to_x = 0.0, to_y = 0.0;  ///< map coordinates
  auto operator<=>(const Segment&) const = default;
};

/// Segments of the squares whose south-west cell lies in `own`, in ascending order (level, then key). `grid` must hold own and, where
/// the survey goes on, one row of cells more to the north and one column more to the east; squares with a void corner give nothing.
/// A centre at or above a level counts as above it. In a saddle the mean of the four heights says which ground is joined.
std::vector<Segment> trace(const core::Grid& grid, const core::Lattice& own, const ContourOptions& options);

}  // namespace swath::terrain
