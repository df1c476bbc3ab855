// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/height.h"

#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

constexpr double per_metre = 1024.0;  // the steps of files (io/las/las_block.cpp): what is finer takes room and is noise

}  // namespace

std::uint64_t height_above(const core::Grid& terrain, core::Block& block, size_t own) {
  const core::Lattice& l = terrain.lattice;
  block.height.resize(block.size());
  std::uint64_t unknown = 0;
  for (size_t k = 0; k < own; ++k) {
    const double u = (block.origin.x() + block.x[k]) / l.cell - 0.5 - static_cast<double>(l.i0);
    const double v = (block.origin.y() + block.y[k]) / l.cell - 0.5 - static_cast<double>(l.j0);
    const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
    const double fu = u - i, fv = v - j;
    double sum = 0.0, weights = 0.0;
    for (int dj = 0; dj < 2; ++dj)
      for (int di = 0; di < 2; ++di) {
        if (!l.holds(i + di, j + dj)) continue;
        const size_t at = l.at(i + di, j + dj);
        if (terrain.reason[at] != core::Void::none) continue;
        const double w = (di ? fu : 1.0 - fu) * (dj ? fv : 1.0 - fv);
        sum += w * static_cast<double>(terrain.height[at]);
        weights += w;
      }
    if (weights > 0.0) {
      const auto height = static_cast<float>(block.origin.z() + block.z[k] - sum / weights);
      block.height[k] = static_cast<float>(std::round(static_cast<double>(height) * per_metre) / per_metre);
    } else {
      block.height[k] = std::numeric_limits<float>::quiet_NaN();
      ++unknown;
    }
  }
  return unknown;
}

}  // namespace swath::filters
