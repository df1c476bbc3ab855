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

/// For each cell the lowest value in those up to deck_heights_reach away, infinite where none has one.
std::vector<float> lowest_around(const core::Lattice& l, const std::vector<float>& value) {
  constexpr float nothing = std::numeric_limits<float>::infinity();
  const auto nx = static_cast<size_t>(l.nx), ny = static_cast<size_t>(l.ny), reach = static_cast<size_t>(deck_heights_reach);
  std::vector<float> row(nx + 2 * reach, nothing), along(l.size(), nothing), out(l.size(), nothing);
  for (size_t j = 0; j < ny; ++j) {
    for (size_t i = 0; i < nx; ++i) row[i + reach] = std::isnan(value[j * nx + i]) ? nothing : value[j * nx + i];
    for (size_t shift = 0; shift <= 2 * reach; ++shift)
      for (size_t i = 0; i < nx; ++i) along[j * nx + i] = std::min(along[j * nx + i], row[i + shift]);
  }
  for (size_t j = 0; j < ny; ++j)
    for (size_t from = j - std::min(j, reach); from < std::min(j + reach + 1, ny); ++from)
      for (size_t i = 0; i < nx; ++i) out[j * nx + i] = std::min(out[j * nx + i], along[from * nx + i]);
  return out;
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
  const std::vector<float> lowest = lowest_around(l, bottom);
  for (size_t c = 0; c < limit.size(); ++c)
    if (const float below = lowest[c] - outlier_depth; std::isfinite(below) && out.low[c] <= below) limit[c] = below, out.low[c] = none;
  if (std::all_of(limit.begin(), limit.end(), [](float z) { return std::isnan(z); })) return out;
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
