// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/paste.h"

#include <algorithm>
#include <cmath>

namespace swath::core {

Lattice common_part(const Lattice& a, const Lattice& b) {
  const std::int64_t i0 = std::max(a.i0, b.i0), i1 = std::max(i0, std::min(a.i0 + a.nx, b.i0 + b.nx));
  const std::int64_t j0 = std::max(a.j0, b.j0), j1 = std::max(j0, std::min(a.j0 + a.ny, b.j0 + b.ny));
  return {a.cell, i0, j0, static_cast<int>(i1 - i0), static_cast<int>(j1 - j0)};
}

void paste(const Grid& tile, Grid& window) {
  const Lattice& from = tile.lattice;
  const Lattice& to = window.lattice;
  const Lattice both = common_part(from, to);
  if (both.size() == 0) return;
  if (!tile.sigma.empty() && window.sigma.empty()) window.sigma.assign(to.size(), std::numeric_limits<float>::quiet_NaN());
  if (!tile.count.empty() && window.count.empty()) window.count.assign(to.size(), 0);
  for (std::int64_t j = both.j0; j < both.j0 + both.ny; ++j) {
    const size_t a = from.at(static_cast<int>(both.i0 - from.i0), static_cast<int>(j - from.j0));
    const size_t b = to.at(static_cast<int>(both.i0 - to.i0), static_cast<int>(j - to.j0));
    const std::ptrdiff_t n = both.nx;
    const auto copy = [&](const auto& source, auto& target) {
      if (!source.empty()) std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(a), n, target.begin() + static_cast<std::ptrdiff_t>(b));
    };
    copy(tile.height, window.height);
    copy(tile.reason, window.reason);
    copy(tile.sigma, window.sigma);
    copy(tile.count, window.count);
  }
}

Lattice known_part(const Grid& grid) {
  const Lattice& l = grid.lattice;
  int west = l.nx, east = -1, south = l.ny, north = -1;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      if (!std::isnan(grid.height[l.at(i, j)]))
        west = std::min(west, i), east = std::max(east, i), south = std::min(south, j), north = std::max(north, j);
  if (east < 0) return {l.cell, l.i0, l.j0, 0, 0};
  west = std::max(0, west - 1), south = std::max(0, south - 1);
  east = std::min(l.nx - 1, east + 1), north = std::min(l.ny - 1, north + 1);
  return {l.cell, l.i0 + west, l.j0 + south, east - west + 1, north - south + 1};
}

}  // namespace swath::core
