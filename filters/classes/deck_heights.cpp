// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/deck_heights.h"

#include <algorithm>
#include <limits>

#include "filters/bins.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr float none = std::numeric_limits<float>::quiet_NaN();
constexpr float outlier_depth = 1.5f;  // m

/// The lowest value in the cells around, NaN where none has one.
float lowest_around(const core::Lattice& l, const std::vector<float>& value, int i, int j) {
  float lowest = none;
  for (int v = std::max(j - deck_heights_reach, 0); v <= std::min(j + deck_heights_reach, l.ny - 1); ++v)
    for (int u = std::max(i - deck_heights_reach, 0); u <= std::min(i + deck_heights_reach, l.nx - 1); ++u)
      if (const float z = value[l.at(u, v)]; z == z && !(lowest <= z)) lowest = z;
  return lowest;
}

}  // namespace

DeckHeights deck_heights(const core::Block& b, const core::Lattice& l) {
  DeckHeights out{std::vector<float>(l.size(), none), std::vector<float>(l.size(), none), std::vector<std::uint8_t>(l.size(), 0)};
  std::vector<float> bottom(l.size(), none);  // of ground and water
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex at = cell_of(l, b, p);
    const size_t c = l.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    const bool ground = b.classification[p] == cls::ground;
    if (!(z >= out.low[c])) out.low[c] = z;
    if ((ground || b.classification[p] == cls::water) && !(z >= bottom[c])) bottom[c] = z;
    if (ground < out.ground[c]) continue;
    if (ground > out.ground[c] || (ground ? !(z <= out.top[c]) : !(z >= out.top[c]))) out.top[c] = z;
    out.ground[c] = ground;
  }
  std::vector<float> limit(l.size(), none);  // of low outliers, in the cells that hold some
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const size_t c = l.at(i, j);
      const float here = bottom[c];
      if (!(out.low[c] < here || here != here)) continue;
      if (const float below = lowest_around(l, bottom, i, j) - outlier_depth; out.low[c] <= below) limit[c] = below, out.low[c] = none;
    }
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex at = cell_of(l, b, p);
    const size_t c = l.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    if (z > limit[c] && !(z >= out.low[c])) out.low[c] = z;
  }
  return out;
}

}  // namespace swath::filters
