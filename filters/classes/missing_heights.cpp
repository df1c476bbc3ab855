// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/missing_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double cell = 4.0;  // m
constexpr int rings = 6;
constexpr float steep = 2.0f;  // m between levels of one ring: no level to go on with

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
};

}  // namespace

double missing_heights_halo() { return (rings + 1) * cell; }

std::vector<std::uint32_t> fill_missing_heights(core::Block& b) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (core::is_usable(b, p) && std::isnan(b.height[p])) rows.push_back(p);
  if (rows.empty()) return rows;
  const Levels levels(b);
  for (const std::uint32_t p : rows) b.height[p] = static_cast<float>(b.z[p]) - levels.around(cell_of(levels.lattice, b, p));
  return rows;
}

}  // namespace swath::filters
