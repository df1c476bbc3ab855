// SPDX-License-Identifier: GPL-3.0-or-later
// Planes and ground by cells of 1 m of the survey's lattice: what hangs together, and how large it is.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "filters/bins.h"
#include "filters/roof_planes.h"

namespace swath::filters {

/// Row-major as in core::Grid; heights relative to the block's origin, m.
struct StructureCells {
  core::Lattice lattice;
  std::vector<float> plane;   ///< highest planar point; NaN where none
  std::vector<float> height;  ///< of that point above ground
  std::vector<float> ground;  ///< lowest point of class ground; NaN where none
  std::vector<float> low;     ///< lowest usable point; NaN where none
  std::vector<Planar> kind;   ///< of the planar points, the widest

  bool has_plane(size_t c) const { return plane[c] == plane[c]; }
  bool has_ground(size_t c) const { return ground[c] == ground[c]; }
};

constexpr double structure_cell = 1.0;  ///< m
constexpr int structure_link = 2;       ///< cells: those up to so far apart hang together, so that one empty cell parts nothing

/// Cells of the planar points (planar_points) and of the points of class ground; needs columns classification and height.
StructureCells structure_cells(const core::Block& b, const std::vector<Planar>& planar);

/// Marks the cells with planes up to `link(from)` cells from marked ones for which `linked(from, to, distance in cells)` holds, `rounds`
/// times over.
template <class Link, class Linked>
void spread(const StructureCells& cells, std::vector<std::uint8_t>& marked, int rounds, Link&& link, Linked&& linked) {
  const core::Lattice& l = cells.lattice;
  std::vector<std::uint32_t> front, next;
  for (size_t c = 0; c < marked.size(); ++c)
    if (marked[c]) front.push_back(static_cast<std::uint32_t>(c));
  for (; rounds > 0 && !front.empty(); --rounds) {
    next.clear();
    for (const std::uint32_t from : front) {
      const int i = static_cast<int>(from % static_cast<size_t>(l.nx)), j = static_cast<int>(from / static_cast<size_t>(l.nx));
      const int reach = link(from);
      for (int v = std::max(j - reach, 0); v <= std::min(j + reach, l.ny - 1); ++v)
        for (int u = std::max(i - reach, 0); u <= std::min(i + reach, l.nx - 1); ++u) {
          const size_t to = l.at(u, v);
          if (marked[to] || !cells.has_plane(to) || !linked(from, to, std::max(std::abs(u - i), std::abs(v - j)))) continue;
          marked[to] = 1;
          next.push_back(static_cast<std::uint32_t>(to));
        }
    }
    front.swap(next);
  }
}

/// Cells that are linked to cell (i, j) by links from a cell to one up to `link` away for which `linked(from, to)` holds,
/// within the square of `radius` cells around (i, j); the search ends with the cell for which `enough(cell, count so far)` holds. True
/// where there was one. (i, j) itself counts. The result depends on nothing outside the square.
template <class Linked, class Enough>
bool grow(const core::Lattice& l, int i, int j, int radius, int link, Linked&& linked, Enough&& enough) {
  const int side = 2 * radius + 1;
  std::vector<std::uint8_t> seen(static_cast<size_t>(side) * static_cast<size_t>(side), 0);
  const auto local = [&](int di, int dj) {
    return static_cast<size_t>(dj + radius) * static_cast<size_t>(side) + static_cast<size_t>(di + radius);
  };
  std::vector<CellIndex> found{{0, 0}};
  seen[local(0, 0)] = 1;
  for (size_t n = 0; n < found.size(); ++n) {
    const CellIndex from = found[n];
    const size_t cell = l.at(i + from.i, j + from.j);
    if (enough(cell, static_cast<int>(n) + 1)) return true;
    for (int dj = -link; dj <= link; ++dj)
      for (int di = -link; di <= link; ++di) {
        const CellIndex to{from.i + di, from.j + dj};
        if (std::max(std::abs(to.i), std::abs(to.j)) > radius || !l.holds(i + to.i, j + to.j) || seen[local(to.i, to.j)]) continue;
        if (!linked(cell, l.at(i + to.i, j + to.j))) continue;
        seen[local(to.i, to.j)] = 1;
        found.push_back(to);
      }
  }
  return false;
}

}  // namespace swath::filters
