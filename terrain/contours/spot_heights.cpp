// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/spot_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace swath::terrain {
namespace {

/// Looks at cells around one; `sign` is 1 for tops and -1 for pits.
class Search {
 public:
  Search(const core::Grid& grid, const SpotOptions& o)
      : grid_(grid), relief_(o.relief.value), reach_(static_cast<int>(std::floor(o.radius.value / grid.lattice.cell))) {
    const double square = o.radius.value * o.radius.value / (grid.lattice.cell * grid.lattice.cell);
    const int up = std::min(reach_, grid.lattice.ny - 1), across = std::min(reach_, grid.lattice.nx - 1);
    for (int dj = -up; dj <= up; ++dj)
      for (int di = -across; di <= across; ++di)
        if ((di != 0 || dj != 0) && di * di + dj * dj <= square) disc_.emplace_back(di, dj);
    // The nearest first: most candidates fail there.
    std::sort(disc_.begin(), disc_.end(), [](const auto& a, const auto& b) {
      const int da = a.first * a.first + a.second * a.second, db = b.first * b.first + b.second * b.second;
      return da != db ? da < db : a < b;
    });
  }

  bool holds(int i, int j, double sign) const {
    const core::Lattice& l = grid_.lattice;
    const double here = grid_.height[l.at(i, j)];
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        if (!l.holds(i + di, j + dj) || std::isnan(grid_.height[l.at(i + di, j + dj)])) return false;
    double sum = 0.0;
    int n = 0;
    for (const auto& [di, dj] : disc_) {
      if (!l.holds(i + di, j + dj)) continue;
      const double there = grid_.height[l.at(i + di, j + dj)];
      if (std::isnan(there)) continue;
      const bool first = dj < 0 || (dj == 0 && di < 0);
      if (sign * there > sign * here || (there == here && first)) return false;
      sum += there - here;
      ++n;
    }
    return n > 0 && -sign * sum / n >= relief_;
  }

 private:
  const core::Grid& grid_;
  double relief_;
  int reach_;
  std::vector<std::pair<int, int>> disc_;
};

}  // namespace

double halo(const SpotOptions& o) { return o.radius.value; }

std::vector<SpotHeight> spot_heights(const core::Grid& grid, const core::Lattice& own, const SpotOptions& options) {
  std::vector<SpotHeight> out;
  if (options.radius.value <= 0.0) return out;
  const Search search(grid, options);
  const core::Lattice& l = grid.lattice;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const int gi = static_cast<int>(own.i0 + i - l.i0), gj = static_cast<int>(own.j0 + j - l.j0);
      if (!l.holds(gi, gj)) continue;
      const double height = grid.height[l.at(gi, gj)];
      if (std::isnan(height)) continue;
      for (const double sign : {1.0, -1.0})
        if (search.holds(gi, gj, sign)) out.push_back({own.j0 + j, own.i0 + i, height, sign > 0 ? 1 : 0});
    }
  return out;
}

}  // namespace swath::terrain
