// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrants are asked of a summed-area table of occupied cells: constant time per cell whatever the reach.
#include "terrain/voids.h"

#include <algorithm>
#include <cmath>

namespace swath::terrain {
namespace {

/// Sums of `occupied` over any rectangle of a lattice.
class SummedArea {
 public:
  explicit SummedArea(const core::Lattice& l, const std::vector<std::uint32_t>& counts) : stride_(static_cast<size_t>(l.nx) + 1) {
    sum_.assign(stride_ * (static_cast<size_t>(l.ny) + 1), 0);
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i)
        sum_[at(i + 1, j + 1)] = (counts[l.at(i, j)] > 0 ? 1u : 0u) + sum_[at(i, j + 1)] + sum_[at(i + 1, j)] - sum_[at(i, j)];
  }
  /// Whether any cell of [i0, i1] x [j0, j1] is occupied.
  bool any(int i0, int j0, int i1, int j1) const {
    return sum_[at(i1 + 1, j1 + 1)] + sum_[at(i0, j0)] != sum_[at(i0, j1 + 1)] + sum_[at(i1 + 1, j0)];
  }

 private:
  size_t at(int i, int j) const { return static_cast<size_t>(j) * stride_ + static_cast<size_t>(i); }
  size_t stride_;
  std::vector<std::uint32_t> sum_;
};

}  // namespace

std::vector<std::uint32_t> count_points(const core::Block& block, const std::vector<std::uint32_t>& rows, const core::Lattice& window) {
  std::vector<std::uint32_t> counts(window.size(), 0);
  for (const std::uint32_t r : rows) {
    if (!std::isfinite(block.x[r]) || !std::isfinite(block.y[r])) continue;
    const std::int64_t i = core::cell_index(block.x[r] + block.origin.x(), window.cell) - window.i0;
    const std::int64_t j = core::cell_index(block.y[r] + block.origin.y(), window.cell) - window.j0;
    if (i >= 0 && j >= 0 && i < window.nx && j < window.ny) ++counts[window.at(static_cast<int>(i), static_cast<int>(j))];
  }
  return counts;
}

void give_void_reasons(core::Grid& grid, const core::Block& block, const std::vector<std::uint32_t>& rows, double reach) {
  const core::Lattice& l = grid.lattice;
  if (std::none_of(grid.height.begin(), grid.height.end(), [](float h) { return std::isnan(h); })) {
    std::fill(grid.reason.begin(), grid.reason.end(), core::Void::none);
    return;
  }
  const int h = static_cast<int>(std::floor(reach / l.cell));
  const core::Lattice wide{l.cell, l.i0 - h, l.j0 - h, l.nx + 2 * h, l.ny + 2 * h};
  const SummedArea occupied(wide, count_points(block, rows, wide));
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const size_t at = l.at(i, j);
      if (!std::isnan(grid.height[at])) {
        grid.reason[at] = core::Void::none;
        continue;
      }
      const int ci = i + h, cj = j + h;
      // A pinwheel of four rectangles: each axis belongs to one quadrant, the cell itself to none.
      const bool surrounded = occupied.any(ci + 1, cj, ci + h, cj + h) && occupied.any(ci - h, cj + 1, ci, cj + h) &&
                              occupied.any(ci - h, cj - h, ci - 1, cj) && occupied.any(ci, cj - h, ci + h, cj - 1);
      grid.reason[at] = surrounded ? core::Void::long_edge : core::Void::no_data;
    }
}

void mark_never_seen(core::Grid& surface, const core::Grid& seen) {
  const core::Lattice& l = surface.lattice;
  const core::Lattice& other = seen.lattice;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      core::Void& reason = surface.reason[l.at(i, j)];
      if (reason == core::Void::none || reason == core::Void::water) continue;
      const int oi = static_cast<int>(core::cell_index(l.centre_x(i), other.cell) - other.i0);
      const int oj = static_cast<int>(core::cell_index(l.centre_y(j), other.cell) - other.j0);
      if (other.holds(oi, oj) && seen.reason[other.at(oi, oj)] == core::Void::never_seen) reason = core::Void::never_seen;
    }
}

}  // namespace swath::terrain
