// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/bins.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/wide.h"

namespace swath::filters {
namespace {

struct Extent {
  double low, high;
};

/// Of the first n values; there must be one.
SWATH_WIDE Extent extent_of(const double* v, size_t n) {
  constexpr size_t lanes = 8;
  double low[lanes], high[lanes];
  for (size_t k = 0; k < lanes; ++k) low[k] = high[k] = v[0];
  size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    for (size_t k = 0; k < lanes; ++k) {
      low[k] = v[i + k] < low[k] ? v[i + k] : low[k];
      high[k] = v[i + k] > high[k] ? v[i + k] : high[k];
    }
  Extent e{*std::min_element(low, low + lanes), *std::max_element(high, high + lanes)};
  for (; i < n; ++i) e.low = std::min(e.low, v[i]), e.high = std::max(e.high, v[i]);
  return e;
}

/// The cells that hold a box in the block and `around` about it, and `border` more.
core::Lattice lattice_of(const core::Block& b, Extent x, Extent y, double cell, double around, int border) {
  const std::int64_t i0 = core::cell_index(b.origin.x() + x.low - around, cell) - border;
  const std::int64_t j0 = core::cell_index(b.origin.y() + y.low - around, cell) - border;
  const std::int64_t i1 = core::cell_index(b.origin.x() + x.high + around, cell) + border;
  const std::int64_t j1 = core::cell_index(b.origin.y() + y.high + around, cell) + border;
  return {cell, i0, j0, static_cast<int>(i1 - i0) + 1, static_cast<int>(j1 - j0) + 1};
}

SWATH_WIDE void cells_of(const double* v, double origin, double cell, double first, std::int32_t* out, size_t n) {
  for (size_t k = 0; k < n; ++k) out[k] = static_cast<std::int32_t>(std::floor((origin + v[k]) / cell) - first);
}

}  // namespace

void cells_of(const core::Lattice& l, const core::Block& b, size_t first, size_t n, std::int32_t* column, std::int32_t* row) {
  cells_of(b.x.data() + first, b.origin.x(), l.cell, static_cast<double>(l.i0), column, n);
  cells_of(b.y.data() + first, b.origin.y(), l.cell, static_cast<double>(l.j0), row, n);
}

core::Lattice lattice_around(const core::Block& b, double cell, int border) {
  if (b.size() == 0) return {cell, 0, 0, 0, 0};
  return lattice_around(b, b.size(), cell, 0.0, border);
}

core::Lattice lattice_around(const core::Block& b, size_t own, double cell, double around, int border) {
  return lattice_of(b, extent_of(b.x.data(), own), extent_of(b.y.data(), own), cell, around, border);
}

core::Lattice lattice_around(const core::Block& b, const std::vector<std::uint8_t>& taken, double cell, int border) {
  constexpr double none = std::numeric_limits<double>::infinity();
  Extent x{none, -none}, y = x;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!taken[p]) continue;
    x = {std::min(x.low, b.x[p]), std::max(x.high, b.x[p])};
    y = {std::min(y.low, b.y[p]), std::max(y.high, b.y[p])};
  }
  return x.low > x.high ? core::Lattice{cell, 0, 0, 0, 0} : lattice_of(b, x, y, cell, 0.0, border);
}

OwnBox::OwnBox(const core::Block& b, size_t own, double around) : origin_(b.origin), west_(1), east_(0), south_(1), north_(0) {
  if (own == 0) return;
  const auto [west, east] = extent_of(b.x.data(), own);
  const auto [south, north] = extent_of(b.y.data(), own);
  west_ = west - around, east_ = east + around, south_ = south - around, north_ = north + around;
}

bool OwnBox::touches(const core::Lattice& l, int i, int j) const {
  const double x = l.centre_x(i) - origin_.x(), y = l.centre_y(j) - origin_.y(), half = 0.5 * l.cell;
  return x + half >= west_ && x - half <= east_ && y + half >= south_ && y - half <= north_;
}

Bins::Bins(const core::Block& b, double cell, int border, const std::function<bool(size_t)>& takes_part)
    : lattice_(lattice_around(b, cell, border)) {
  constexpr std::uint32_t left_out = 0xffffffffu;
  std::vector<std::uint32_t> cell_of_point(b.size(), left_out);
  start_.assign(lattice_.size() + 1, 0);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!takes_part(p)) continue;
    const CellIndex c = cell_of(lattice_, b, p);
    cell_of_point[p] = static_cast<std::uint32_t>(lattice_.at(c.i, c.j));
    ++start_[cell_of_point[p] + 1];
  }
  for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  points_.resize(start_.back());
  rows_.resize(start_.back());
  for (size_t p = 0; p < b.size(); ++p) {
    if (cell_of_point[p] == left_out) continue;
    const std::uint32_t at = next[cell_of_point[p]]++;
    points_[at] = {b.x[p], b.y[p], b.z[p]};
    rows_[at] = static_cast<std::uint32_t>(p);
  }
}

}  // namespace swath::filters
