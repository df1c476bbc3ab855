// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/missing_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double cell = 4.0;  // m
constexpr int rings = 6;
constexpr float steep = 2.0f;          // m between levels of one ring: no level to go on with
constexpr int void_cells = 25;         // to each side of a place in a void
constexpr double void_grade = 0.15;    // rise / run of the ground below
constexpr float clearly_above = 2.0f;  // m
constexpr float unfilled = std::numeric_limits<float>::quiet_NaN();

/// Level of the ground by cells: the lowest that the heights of their points state; NaN where none has a height.
struct Levels {
  core::Lattice lattice;
  std::vector<float> level;

  explicit Levels(const core::Block& b)
      : lattice(lattice_around(b, cell, 0)), level(lattice.size(), std::numeric_limits<float>::quiet_NaN()) {
    for (size_t p = 0; p < b.size(); ++p) {
      if (!core::is_usable(b, p) || std::isnan(b.height[p])) continue;
      const CellIndex at = cell_of(lattice, b, p);
      float& lowest = level[lattice.at(at.i, at.j)];
      const float ground = static_cast<float>(b.z[p]) - b.height[p];
      if (!(lowest <= ground)) lowest = ground;
    }
  }

  /// In the nearest ring of cells that has any, where these agree.
  float around(CellIndex at) const {
    for (int ring = 0; ring <= rings; ++ring) {
      float lowest = std::numeric_limits<float>::quiet_NaN(), highest = lowest;
      for (int dj = -ring; dj <= ring; ++dj)
        for (int di = -ring; di <= ring; di += std::abs(dj) == ring || di == ring ? 1 : 2 * ring) {
          if (!lattice.holds(at.i + di, at.j + dj)) continue;
          const float l = level[lattice.at(at.i + di, at.j + dj)];
          if (std::isnan(l)) continue;
          if (!(lowest <= l)) lowest = l;
          if (!(highest >= l)) highest = l;
        }
      if (!std::isnan(lowest)) return highest - lowest <= steep ? lowest : std::numeric_limits<float>::quiet_NaN();
    }
    return std::numeric_limits<float>::quiet_NaN();
  }

  /// Is there any level within the rings? Those that differ stay unknown.
  bool is_near(CellIndex at) const {
    for (int j = std::max(at.j - rings, 0); j <= std::min(at.j + rings, lattice.ny - 1); ++j)
      for (int i = std::max(at.i - rings, 0); i <= std::min(at.i + rings, lattice.nx - 1); ++i)
        if (!std::isnan(level[lattice.at(i, j)])) return true;
    return false;
  }

  /// On the shortest straight line through the cell between levels on both sides of it; of equally short ones the lowest.
  float between(CellIndex at) const {
    float best = unfilled;
    double shortest = std::numeric_limits<double>::infinity();
    for (const CellIndex& way : {CellIndex{1, 0}, CellIndex{0, 1}, CellIndex{1, 1}, CellIndex{1, -1}}) {
      const double step = std::hypot(way.i, way.j);
      const auto [one, z] = first(at, way, static_cast<int>(void_cells / step));
      const auto [other, w] = first(at, {-way.i, -way.j}, static_cast<int>(void_cells / step));
      const double length = step * cell * (one + other);
      if (one == 0 || other == 0 || static_cast<double>(std::abs(z - w)) > void_grade * length || length > shortest) continue;
      const float here = z + (w - z) * static_cast<float>(one) / static_cast<float>(one + other);
      best = length < shortest ? here : std::min(best, here);
      shortest = length;
    }
    return best;
  }

  /// Steps to the first cell with a level, and that; 0 where there is none.
  std::pair<int, float> first(CellIndex at, CellIndex way, int most) const {
    for (int k = 1; k <= most; ++k) {
      const CellIndex to{at.i + k * way.i, at.j + k * way.j};
      if (!lattice.holds(to.i, to.j)) break;
      if (const float l = level[lattice.at(to.i, to.j)]; !std::isnan(l)) return {k, l};
    }
    return {0, unfilled};
  }
};

}  // namespace

double missing_heights_halo() { return (rings + 1) * cell; }

double across_voids_halo() { return (void_cells + 1) * cell; }

MissingHeights fill_missing_heights(core::Block& b, const OwnBox& across) {
  MissingHeights rows;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (core::is_usable(b, p) && std::isnan(b.height[p])) rows.all.push_back(p);
  if (rows.all.empty()) return rows;
  const Levels levels(b);
  for (const std::uint32_t p : rows.all) {
    const CellIndex at = cell_of(levels.lattice, b, p);
    const auto z = static_cast<float>(b.z[p]);
    b.height[p] = z - levels.around(at);
    if (!std::isnan(b.height[p]) || levels.is_near(at) || !across.holds(b, p)) continue;
    if (const float height = z - levels.between(at); height >= clearly_above) {
      b.height[p] = height;
      rows.across.push_back(p);
    }
  }
  return rows;
}

}  // namespace swath::filters
