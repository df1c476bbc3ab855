// SPDX-License-Identifier: GPL-3.0-or-later
// Cover by first returns: that of all returns counts a crown as often as the pulse has echoes in it (Morsdorf et al. 2006).
#include "terrain/forest/canopy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::terrain {
namespace {

namespace cls = core::point_class;

float percentile(const std::vector<float>& sorted, int percent) {
  const double at = static_cast<double>(sorted.size() - 1) * percent / 100.0;
  const auto low = static_cast<size_t>(at), high = std::min(low + 1, sorted.size() - 1);
  const auto share = static_cast<float>(at - static_cast<double>(low));
  return sorted[low] + share * (sorted[high] - sorted[low]);
}

}  // namespace

bool is_of_forest(const core::Block& b, size_t p) {
  if (!core::is_usable(b, p) || !std::isfinite(b.height[p])) return false;
  const std::uint8_t c = b.classification[p];
  return c <= cls::high_vegetation;
}

CanopyCells canopy_cells(const core::Block& b, const core::Lattice& window, double least_height) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::vector<float>> heights(window.size());
  std::vector<std::uint32_t> first(window.size()), high(window.size());
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_of_forest(b, p)) continue;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], window.cell) - window.i0;
    const std::int64_t j = core::cell_index(b.origin.y() + b.y[p], window.cell) - window.j0;
    if (i < 0 || j < 0 || i >= window.nx || j >= window.ny) continue;
    const size_t c = window.at(static_cast<int>(i), static_cast<int>(j));
    const bool is_high = static_cast<double>(b.height[p]) >= least_height;
    if (is_high) heights[c].push_back(b.height[p]);
    if (!b.return_number.empty() && b.return_number[p] > 1) continue;
    ++first[c];
    high[c] += is_high;
  }
  CanopyCells out;
  out.cover.assign(window.size(), none);
  out.first_returns.assign(window.size(), none);
  for (auto& h : out.height) h.assign(window.size(), none);
  for (size_t c = 0; c < window.size(); ++c) {
    if (first[c] == 0) continue;
    out.first_returns[c] = static_cast<float>(first[c]);
    out.cover[c] = static_cast<float>(high[c]) / static_cast<float>(first[c]);
    if (heights[c].empty()) continue;
    std::sort(heights[c].begin(), heights[c].end());
    for (size_t k = 0; k < canopy_percentiles.size(); ++k) out.height[k][c] = percentile(heights[c], canopy_percentiles[k]);
  }
  return out;
}

}  // namespace swath::terrain
