// SPDX-License-Identifier: GPL-3.0-or-later
// Planes and ground by cells of 1 m of the survey's lattice: what is connected, and how large it is.
#pragma once

#include <algorithm>
#include <bit>
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

/// Cells of the planar points (planar_points) and of the points of class ground within the lattice, whose cells are structure_cell wide;
/// needs columns classification and height.
StructureCells structure_cells(const core::Block& b, const std::vector<Planar>& planar, const core::Lattice& l);

/// Cells of a lattice that are still to be found, as bits, so that what is closed costs nothing to pass.
class OpenCells {
 public:
  template <class May>
  OpenCells(const core::Lattice& l, May&& may)
      : words_((static_cast<size_t>(l.nx) + 63) / 64 + 1), bits_(words_ * static_cast<size_t>(l.ny), 0) {
    for (int j = 0; j < l.ny; ++j)
      for (int west = 0; west < l.nx; west += 64) {
        std::uint64_t row = 0;
        for (int i = std::min(west + 63, l.nx - 1); i >= west; --i) row = row << 1 | static_cast<std::uint64_t>(may(l.at(i, j)) ? 1 : 0);
        word(west, j) = row;
      }
  }

  void open(int i, int j) { word(i, j) |= bit(i); }
  void close(int i, int j) { word(i, j) &= ~bit(i); }
  /// Columns from `west` to `east`, 63 at most, as bits from the lowest on.
  std::uint64_t in_row(int west, int east, int j) const {
    const std::uint64_t* const at = &bits_[static_cast<size_t>(j) * words_ + static_cast<size_t>(west) / 64];
    const int shift = west % 64;
    const std::uint64_t from = shift == 0 ? at[0] : at[0] >> shift | at[1] << (64 - shift);
    return from & ((std::uint64_t{1} << (east - west + 1)) - 1);
  }

 private:
  std::uint64_t& word(int i, int j) { return bits_[static_cast<size_t>(j) * words_ + static_cast<size_t>(i) / 64]; }
  static std::uint64_t bit(int i) { return std::uint64_t{1} << (i % 64); }

  size_t words_;  ///< of a row, one more than it needs
  std::vector<std::uint64_t> bits_;
};

/// Marks the cells with planes up to `link(from)` cells from marked ones for which `linked(from, to, distance in cells)` holds, `rounds`
/// times over.
template <class Link, class Linked>
void spread(const StructureCells& cells, std::vector<std::uint8_t>& marked, int rounds, Link&& link, Linked&& linked) {
  const core::Lattice& l = cells.lattice;
  std::vector<std::uint32_t> front, next;
  for (size_t c = 0; c < marked.size(); ++c)
    if (marked[c]) front.push_back(static_cast<std::uint32_t>(c));
  if (front.empty()) return;
  OpenCells open(l, [&](size_t c) { return !marked[c] && cells.has_plane(c); });
  for (; rounds > 0 && !front.empty(); --rounds) {
    next.clear();
    for (const std::uint32_t from : front) {
      const int i = static_cast<int>(from % static_cast<size_t>(l.nx)), j = static_cast<int>(from / static_cast<size_t>(l.nx));
      const int reach = link(from), west = std::max(i - reach, 0), east = std::min(i + reach, l.nx - 1);
      for (int v = std::max(j - reach, 0); v <= std::min(j + reach, l.ny - 1); ++v)
        for (std::uint64_t row = open.in_row(west, east, v); row != 0; row &= row - 1) {
          const int u = west + std::countr_zero(row);
          const size_t to = l.at(u, v);
          if (!linked(from, to, std::max(std::abs(u - i), std::abs(v - j)))) continue;
          marked[to] = 1;
          open.close(u, v);
          next.push_back(static_cast<std::uint32_t>(to));
        }
    }
    front.swap(next);
  }
}

/// Region growing within a square by the cells that `may` holds for; keeps its memory from one region to the next.
class Growth {
 public:
  template <class May>
  Growth(const core::Lattice& l, int radius, May&& may) : lattice_(l), radius_(radius), open_(l, may) {}

  /// Offsets of the cells that are linked to cell (i, j), one that may be found, by links from a cell to one up to `link` away for which
  /// `linked(from, to)` holds, within the square of `radius` cells around (i, j), (i, j) first; it ends with as many cells as `wanted`.
  /// Depends on nothing outside the square.
  template <class Linked>
  const std::vector<CellIndex>& from(int i, int j, int link, size_t wanted, Linked&& linked) {
    found_.assign(1, {0, 0});
    open_.close(i, j);
    grow(i, j, link, wanted, linked);
    for (const CellIndex& c : found_) open_.open(i + c.i, j + c.j);
    return found_;
  }

 private:
  template <class Linked>
  void grow(int i, int j, int link, size_t wanted, Linked&& linked) {
    const int first = std::max(i - radius_, 0), last = std::min(i + radius_, lattice_.nx - 1);
    const int low = std::max(j - radius_, 0), high = std::min(j + radius_, lattice_.ny - 1);
    for (size_t n = 0; n < found_.size(); ++n) {
      const CellIndex at{i + found_[n].i, j + found_[n].j};
      const size_t cell = lattice_.at(at.i, at.j);
      const int west = std::max(at.i - link, first), east = std::min(at.i + link, last);
      for (int v = std::max(at.j - link, low); v <= std::min(at.j + link, high); ++v)
        for (std::uint64_t row = open_.in_row(west, east, v); row != 0; row &= row - 1) {
          if (found_.size() >= wanted) return;
          const int u = west + std::countr_zero(row);
          if (!linked(cell, lattice_.at(u, v))) continue;
          open_.close(u, v);
          found_.push_back({u - i, v - j});
        }
    }
  }

  const core::Lattice& lattice_;
  int radius_;
  OpenCells open_;
  std::vector<CellIndex> found_;
};

}  // namespace swath::filters
