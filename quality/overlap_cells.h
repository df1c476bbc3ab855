// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of flight lines against one another cell by cell: an image of the differences, and their distribution by pair and line.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/config/result.h"
#include "core/grid.h"
#include "quality/line_cells.h"

namespace swath::quality {

/// Two lines on the smooth level cells (up to 10 deg) of one tile; plain data.
struct OverlapSums {
  std::int32_t line_a = 0, line_b = 0;
  std::uint64_t cells = 0, predicted_cells = 0;
  double sum = 0.0, squares = 0.0;                          ///< m, m2: of a minus b
  double predicted = 0.0, squares_there = 0.0;              ///< m2: variances by the points' own sigmas, squares of the same cells
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0;  ///< around the cells' centres, m
};

/// Cells of a pair whose difference rounds to `bin` half millimetres.
struct OverlapBin {
  std::int32_t line_a = 0, line_b = 0, bin = 0;
  std::uint32_t cells = 0;
};

/// The smooth level cells of one line.
struct SmoothSums {
  std::int32_t line = 0;
  std::uint64_t cells = 0;
  double squares = 0.0, freedom = 0.0;  ///< m2: of returns about their cell's plane; their degrees of freedom
};

/// Cells of a line whose scatter over quartile_of() rounds to `bin` tenths of a millimetre.
struct SmoothBin {
  std::int32_t line = 0, bin = 0;
  std::uint64_t cells = 0;
};

struct OverlapCells {
  core::Grid difference;  ///< height: of several lines the largest difference of two, lower line number minus higher, m; count: lines
  std::vector<OverlapSums> pairs;
  std::vector<OverlapBin> bins;
  std::vector<SmoothSums> lines;
  std::vector<SmoothBin> line_bins;
};

/// The cells of `window` (its cell is the one compared), each by the plane of every line's single returns that fits within
/// `options.roughness`. Needs the column strip; without it all points are of line 0. The image has steeper cells, too, for there an error
/// of place shows.
OverlapCells compare_overlaps(const core::Block& block, const core::Lattice& window, const LineOptions& options);

struct SwathPair {
  int line_a = 0, line_b = 0;
  std::uint64_t cells = 0;
  double mean = 0.0, median = 0.0, rms = 0.0, q95 = 0.0;  ///< m, of a minus b; q95 of its absolute value
  double predicted = 0.0;                                 ///< m: rms of the sigmas that the points' own predict; NaN without them
  double error_over_sigma = 0.0;
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0;  ///< around the compared cells' centres, m
};

template <class V>
void describe(const SwathPair& r, V& v) {
  using core::metres;
  v.result("line_a", r.line_a, "Number of one flight line.");
  v.result("line_b", r.line_b, "Number of the other.");
  v.result("cells", r.cells, "Smooth level cells that both lines see.");
  v.result("mean_m", r.mean, metres(4), "Height of a minus height of b, mean.");
  v.result("median_m", r.median, metres(4), "Its median.");
  v.result("rms_m", r.rms, metres(4), "Its root mean square.");
  v.result("q95_m", r.q95, metres(4), "95 % of its absolute values are smaller.");
  v.result("predicted_m", r.predicted, metres(4), "Sigma of the difference by the points' own sigmas, rms.");
  v.result("error_over_sigma", r.error_over_sigma, "rms over predicted; 1 where the points' sigmas are true.");
  v.result("west", r.west, "Western border of the cells that were compared, m.");
  v.result("south", r.south, "Southern border.");
  v.result("east", r.east, "Eastern border.");
  v.result("north", r.north, "Northern border.");
}

struct SwathLine {
  int line = 0;
  std::uint64_t cells = 0;
  double rms = 0.0, hard = 0.0;  ///< m: scatter of a return about its cell's plane; that of the smoothest quarter
};

/// Both of all lines; `all`: every pair together, its lines 0.
struct SwathOverlaps {
  std::vector<SwathPair> pairs;
  std::vector<SwathLine> lines;
  SwathPair all;
  double hard = 0.0;                    ///< m, rms over the lines; NaN where no line has a smooth cell
  std::vector<double> bins, bin_cells;  ///< of the differences of all pairs: middles of bins of 5 mm, m, and how many cells lie in each
};

/// Joins the records of all tiles; the answer does not depend on their order.
SwathOverlaps judge_overlaps(const OverlapCells& of_all_tiles);

}  // namespace swath::quality
