// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of flight lines compared place by place where they overlap, from the points alone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"

namespace swath::quality {

struct LineOptions {
  std::optional<core::Metres> cell;
  core::Metres roughness{0.10};
  int least = 8;
};

template <class V>
void describe(LineOptions& o, V& v) {
  v.option("cell", o.cell, core::within(0.5, 20.0), "Side of the cells in which lines are compared; by default 2, 4 or 8 m by density.");
  v.option("roughness", o.roughness, core::within(0.005, 1.0),
           "Compare a cell where each line's single returns fit a plane of their own within this rms.");
  v.option("least", o.least, core::within(5, 1000), "Least number of single returns of a line in a cell that is compared.");
}

/// Two lines on the smooth cells that they share in one block of 16 x 16 of the narrowest cells: level ones, or those of one aspect.
struct LineDifference {
  std::int32_t level = 0;     ///< the cells' sides are the narrowest, doubled this many times
  std::int32_t i = 0, j = 0;  ///< block of the absolute lattice
  std::int32_t line_a = 0, line_b = 0;
  std::uint32_t cells = 0;
  float difference = 0.0F;  ///< m, height of a minus b, median of the cells
  float spread = 0.0F;      ///< m, standard deviation of a cell's difference, from the median absolute deviation
  float slope = 0.0F;       ///< rise / run, rms of the cells
  std::int32_t aspect = 0;  ///< 0: level ground; 1 to 4: steep ground that falls to the east, north, west, south
  auto operator<=>(const LineDifference&) const = default;
};

/// How a line's returns scatter about planes in the smooth cells of one block.
struct LineScatter {
  std::int32_t level = 0;
  std::int32_t i = 0, j = 0;
  std::int32_t line = 0;
  std::uint32_t cells = 0;
  float sigma = 0.0F;  ///< m, standard deviation of one return's height: of the smoothest quarter of the cells, allowing for that
                       ///< choice; of level cells, or of steep ones where the block has too few of those
  auto operator<=>(const LineScatter&) const = default;
};

struct LineCells {
  std::vector<LineDifference> differences;
  std::vector<LineScatter> scatters;
};

/// Sides of the cells, narrowest first, m.
std::vector<double> cell_sides(const LineOptions& o);

/// Metres of points around a tile that its result depends on: the side of a block.
double halo(const LineOptions& o);

/// Of every block that holds one of the first `own` points. A block that several tiles share comes out the same from each. Needs the
/// column strip; without it all points are of line 0.
LineCells compare_cells(const core::Block& block, size_t own, const LineOptions& o);

}  // namespace swath::quality
