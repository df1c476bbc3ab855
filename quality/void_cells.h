// SPDX-License-Identifier: GPL-3.0-or-later
// Where no first return lies: how evenly a swath is covered, and its voids.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::quality {

/// The spacing that a rule counts in, and that of the points themselves.
struct PulseSpacing {
  double rule = 1.0;    ///< m, ANPS of the specification; of the points where there is none
  double actual = 1.0;  ///< m, of all lines together where most of the survey lies
};

/// Side of the cells that voids are made of: a quarter of the rule's spacing, m.
inline double void_cell(const PulseSpacing& s) { return 0.25 * s.rule; }
/// Metres of points around a window that voids and distribution depend on.
inline double void_halo(double rule) { return 8.0 * rule; }

/// Cells [i0, i1) of row j of the absolute lattice of void_cell() that are void; plain data.
struct VoidRun {
  std::int32_t j = 0, i0 = 0, i1 = 0;
  std::uint32_t rim = 0, rim_water = 0;  ///< cells with a first return on its rim; with one of class water
  std::uint32_t water = 0;               ///< cells of it that lie in known water
  auto operator<=>(const VoidRun&) const = default;
};

/// Voids: places that a disc of radius 2 `rule` without a first return can cover, their edge moved from the first returns inwards to the
/// middle of the gap between them and the void, 0.55 of their spacing (measured with random, regular and two crossing patterns: the
/// area of a square void of 30 spacings of the rule is right to 1.5 %). `window`: cells of void_cell(). Needs no column; classification
/// where it is there.
std::vector<VoidRun> find_voids(const core::Block& block, const core::Lattice& window, const PulseSpacing& spacing);

/// Cells of 2 `rule` of one line, or of all_lines; plain data.
struct EvenCells {
  std::int32_t line = 0;
  std::uint64_t cells = 0, hit = 0;  ///< within the swath; of these, with a first return or more
};

struct EvenSwath {
  core::Grid hit;  ///< height: 1 where a counted cell holds a first return of any line, 0 where it does not
  std::vector<EvenCells> lines{};
};

/// USGS's measure of spatial distribution: of the cells of twice the rule's spacing those with a first return. Counted are the cells of
/// `window` (that size) whose square of 2 x 2 cells, and the eight squares around it, hold a first return: the rim and voids are apart.
EvenSwath even_cells(const core::Block& block, const core::Lattice& window);

}  // namespace swath::quality
