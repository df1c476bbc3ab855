// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/bins.h"

#include <algorithm>

namespace swath::filters {

core::Lattice lattice_around(const core::Block& b, double cell, int border) {
  if (b.size() == 0) return {cell, 0, 0, 0, 0};
  return lattice_around(b, b.size(), cell, 0.0, border);
}

core::Lattice lattice_around(const core::Block& b, size_t own, double cell, double around, int border) {
  const auto [west, east] = std::minmax_element(b.x.begin(), b.x.begin() + static_cast<std::ptrdiff_t>(own));
  const auto [south, north] = std::minmax_element(b.y.begin(), b.y.begin() + static_cast<std::ptrdiff_t>(own));
  const std::int64_t i0 = core::cell_index(b.origin.x() + *west - around, cell) - border;
  const std::int64_t j0 = core::cell_index(b.origin.y() + *south - around, cell) - border;
  const std::int64_t i1 = core::cell_index(b.origin.x() + *east + around, cell) + border;
  const std::int64_t j1 = core::cell_index(b.origin.y() + *north + around, cell) + border;
  return {cell, i0, j0, static_cast<int>(i1 - i0) + 1, static_cast<int>(j1 - j0) + 1};
}

OwnBox::OwnBox(const core::Block& b, size_t own, double around) : origin_(b.origin), west_(1), east_(0), south_(1), north_(0) {
  if (own == 0) return;
  const auto end = static_cast<std::ptrdiff_t>(own);
  const auto [west, east] = std::minmax_element(b.x.begin(), b.x.begin() + end);
  const auto [south, north] = std::minmax_element(b.y.begin(), b.y.begin() + end);
  west_ = *west - around, east_ = *east + around, south_ = *south - around, north_ = *north + around;
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
