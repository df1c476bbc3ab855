// SPDX-License-Identifier: GPL-3.0-or-later
// Density of first returns of every flight line by itself and of all together.
#pragma once

#include <cstdint>
#include <vector>

#include "core/area.h"
#include "core/block.h"
#include "core/config/result.h"
#include "core/grid.h"

namespace swath::quality {

constexpr int all_lines = -1;

/// Is the point a usable first return? Those without a number count.
inline bool is_first(const core::Block& b, std::size_t p) {
  return core::is_usable(b, p) && (b.return_number.empty() || b.return_number[p] <= 1);
}

/// First returns of a line (or all_lines) in cells of one tile; plain data. Inner cells: they and the eight around them hold some, so that
/// the rim of a swath and holes are left out.
struct PulseSums {
  std::int32_t line = 0;
  std::uint64_t cells = 0, pulses = 0, inner_cells = 0, inner_pulses = 0;
  std::uint64_t duplicates = 0;  ///< of all_lines: first returns that were not counted because another one is the same
  core::Box extent{};            ///< of all_lines: around its cells, m; where there are none, empty
};

/// Inner cells of all lines together that hold `pulses`.
struct PulseBin {
  std::uint32_t pulses = 0;
  std::uint64_t cells = 0;
};

struct PulseCells {
  core::Grid density;  ///< height: first returns per m2, no height in an empty cell; count: lines with a first return
  core::Grid single;   ///< height: the same of the densest line of each cell
  std::vector<PulseSums> lines;
  std::vector<PulseBin> bins;
};

/// The cells of `window`; points up to one cell around it are needed. Needs no column; without strip all points are of line 0. `repeated`:
/// 1 for points that are left out (repeated_returns.h), or empty.
PulseCells count_pulses(const core::Block& block, const core::Lattice& window, const std::vector<std::uint8_t>& repeated = {});

/// ANPD and ANPS of one line or of all.
struct LineDensity {
  int line = 0;
  std::uint64_t pulses = 0;
  double area = 0.0;                    ///< m2, of the inner cells; of all with a pulse where there are hardly inner ones
  double density = 0.0, spacing = 0.0;  ///< 1/m2, m
};

template <class V>
void describe(const LineDensity& r, V& v) {
  v.result("line", r.line, "Number of the flight line.");
  v.result("pulses", r.pulses, "First returns.");
  v.result("area_m2", r.area, "Area in which they were counted: without the swath's rim and holes.");
  v.result("density", r.density, "First returns per square metre (nominal pulse density).");
  v.result("spacing_m", r.spacing, core::metres(3), "1 / sqrt(density): nominal pulse spacing.");
}

struct SwathDensity {
  double cell = 0.0;
  LineDensity all{};
  std::uint64_t duplicates = 0;
  double duplicate_share = 0.0;                       ///< of the first returns with them
  double single_density = 0.0, single_spacing = 0.0;  ///< of the sparsest line with more than a tenth of the mean line's pulses
  double low = 0.0, median = 0.0, high = 0.0;         ///< 1/m2: 5, 50, 95 % of the inner cells have less
  core::Box extent{};                                 ///< around the cells with first returns, m
  std::vector<LineDensity> lines{};
};

template <class V>
void describe(const SwathDensity& r, V& v) {
  v.result("cell_m", r.cell, core::metres(2), "Side of the cells.");
  v.result("pulses", r.all.pulses, "First returns of all lines.");
  v.result("duplicates", r.duplicates, core::if_any(), "First returns that share place, time and number with another: not counted.");
  v.result("duplicate_share", r.duplicate_share, core::if_any(), "Their share of the first returns.");
  v.result("area_km2", 1e-6 * r.all.area, "Area in which they were counted.");
  v.result("density", r.all.density, core::plain().in_summary(), "First returns of all lines per square metre (ANPD).");
  v.result("spacing_m", r.all.spacing, core::metres(3).in_summary(), "1 / sqrt(density): ANPS.");
  v.result("single_density", r.single_density, "The same of the sparsest line with more than 10 % of the mean line's pulses (NPD).");
  v.result("single_spacing_m", r.single_spacing, core::metres(3), "Its spacing (NPS).");
  v.result("density_5", r.low, "5 % of the cells have less per square metre.");
  v.result("density_50", r.median, "50 % of the cells have less.");
  v.result("density_95", r.high, "95 % of the cells have less.");
  v.result("west", r.extent.x0, core::metres(2), "Western border of the cells with first returns, m.");
  v.result("south", r.extent.y0, core::metres(2), "Southern border.");
  v.result("east", r.extent.x1, core::metres(2), "Eastern border.");
  v.result("north", r.extent.y1, core::metres(2), "Northern border.");
  v.tables("lines", r.lines, "Flight lines.");
}

/// Joins the records of all tiles. `cell`: side of the cells, m.
SwathDensity judge_density(const std::vector<PulseSums>& lines, const std::vector<PulseBin>& bins, double cell);

}  // namespace swath::quality
