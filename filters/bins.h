// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a block by cells of the survey-wide lattice.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::filters {

/// The cells that hold all points of the block, grown by `border` cells on each side; empty for an empty block.
/// Only its extent follows the block: cells lie on whole multiples of `cell` (CRS units) in map coordinates.
core::Lattice lattice_around(const core::Block& b, double cell, int border);
/// The same for the first `own` points and `around` (CRS units) about them; there must be one.
core::Lattice lattice_around(const core::Block& b, size_t own, double cell, double around, int border);
/// The same for the points with `taken`.
core::Lattice lattice_around(const core::Block& b, const std::vector<std::uint8_t>& taken, double cell, int border);

/// Column and row of point p in the lattice.
struct CellIndex {
  int i = 0, j = 0;
};
inline CellIndex cell_of(const core::Lattice& l, const core::Block& b, size_t p) {
  return {static_cast<int>(core::cell_index(b.origin.x() + b.x[p], l.cell) - l.i0),
          static_cast<int>(core::cell_index(b.origin.y() + b.y[p], l.cell) - l.j0)};
}

/// Column and row in the lattice of n points from `first` on; those outside get what is outside.
void cells_of(const core::Lattice& l, const core::Block& b, size_t first, size_t n, std::int32_t* column, std::int32_t* row);

/// The box in plan of the first `own` points, grown by `around` (CRS units): what is outside has no say in what is asked of them.
class OwnBox {
 public:
  OwnBox(const core::Block& b, size_t own, double around);
  bool holds(const core::Block& b, size_t p) const { return b.x[p] >= west_ && b.x[p] <= east_ && b.y[p] >= south_ && b.y[p] <= north_; }
  /// Does any part of the cell lie in it?
  bool touches(const core::Lattice& l, int i, int j) const;

 private:
  Eigen::Vector3d origin_;
  double west_, east_, south_, north_;  ///< as in the block
};

/// Points sorted by cell (counting sort). Within a cell they stand in the order of the block: users must not let that order decide.
/// Memory: 28 bytes per point and 4 per cell of the block's extent.
class Bins {
 public:
  struct Point {
    double x, y, z;  ///< as in the block
  };

  /// Bins the points for which `takes_part` holds; `border` empty cells around.
  Bins(const core::Block& b, double cell, int border, const std::function<bool(size_t)>& takes_part);

  const core::Lattice& lattice() const { return lattice_; }
  std::span<const Point> in(int i, int j) const {
    const size_t c = lattice_.at(i, j);
    return {points_.data() + start_[c], start_[c + 1] - start_[c]};
  }
  /// Rows in the block of in(i, j).
  std::span<const std::uint32_t> rows(int i, int j) const {
    const size_t c = lattice_.at(i, j);
    return {rows_.data() + start_[c], start_[c + 1] - start_[c]};
  }

 private:
  core::Lattice lattice_;
  std::vector<std::uint32_t> start_;
  std::vector<std::uint32_t> rows_;
  std::vector<Point> points_;
};

}  // namespace swath::filters
