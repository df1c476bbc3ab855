// SPDX-License-Identifier: GPL-3.0-or-later
// Planes and ground by cells of 1 m of the survey's lattice: what is connected, and how large it is.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "filters/bins.h"
#include "filters/classes/roof_planes.h"

namespace swath::filters {

/// Sums over the planar points of one cell: their number, places from the cell's corner (cm), and products of these. Whole numbers, so that
/// the order of the points does not matter.
struct PlanarSums {
  std::int32_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

/// Row-major as in core::Grid; heights relative to the block's origin, m.
struct StructureCells {
  core::Lattice lattice;
  std::vector<float> plane;   ///< highest planar point; NaN where none
  std::vector<float> height;  ///< of that point above ground
  std::vector<float> ground;  ///< lowest point of class ground; NaN where none
  std::vector<float> low;     ///< lowest usable point; NaN where none
  std::vector<Planar> kind;   ///< of the planar points, the widest
  std::vector<PlanarSums> sums;

  bool has_plane(size_t c) const { return plane[c] == plane[c]; }
  bool has_ground(size_t c) const { return ground[c] == ground[c]; }
};

constexpr double structure_cell = 1.0;  ///< m
constexpr int structure_link = 2;       ///< cells: those up to so far apart are connected, so that one empty cell parts nothing

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

/// Region growing by cells within a square; keeps its memory from one region to the next.
class Growth {
 public:
  Growth(const core::Lattice& l, int radius) : lattice_(l), radius_(radius), seen_(static_cast<size_t>(side()) * side(), 0) {}

  /// Offsets of the cells that are linked to cell (i, j) by links from a cell to one up to `link` away for which `linked(from, to)` holds,
  /// within the square of `radius` cells around (i, j), (i, j) first; it ends with as many cells as `wanted`. Depends on nothing outside
  /// the square.
  template <class Linked>
  const std::vector<CellIndex>& from(int i, int j, int link, size_t wanted, Linked&& linked) {
    for (const CellIndex& c : found_) seen_[local(c)] = 0;
    found_.assign(1, {0, 0});
    seen_[local({0, 0})] = 1;
    for (size_t n = 0; n < found_.size(); ++n) {
      const CellIndex at = found_[n];
      const size_t cell = lattice_.at(i + at.i, j + at.j);
      const int west = std::max({at.i - link, -radius_, -i}), east = std::min({at.i + link, radius_, lattice_.nx - 1 - i});
      const int south = std::max({at.j - link, -radius_, -j}), north = std::min({at.j + link, radius_, lattice_.ny - 1 - j});
      for (int dj = south; dj <= north; ++dj)
        for (int di = west; di <= east; ++di) {
          if (found_.size() >= wanted) return found_;
          const CellIndex to{di, dj};
          if (!linked(cell, lattice_.at(i + di, j + dj)) || seen_[local(to)]) continue;
          seen_[local(to)] = 1;
          found_.push_back(to);
        }
    }
    return found_;
  }

 private:
  int side() const { return 2 * radius_ + 1; }
  size_t local(CellIndex c) const { return static_cast<size_t>(c.j + radius_) * side() + static_cast<size_t>(c.i + radius_); }

  const core::Lattice& lattice_;
  int radius_;
  std::vector<std::uint8_t> seen_;
  std::vector<CellIndex> found_;
};

}  // namespace swath::filters
