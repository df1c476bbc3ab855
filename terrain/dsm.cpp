// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps are filled from a TIN of the highest returns only: a TIN of all first returns would dip into the crowns at every pulse that
// found its way down. Triangles are bounded by their circumcircle as in terrain/tin/tin.h, so the fill is the same in every tile.
#include "terrain/dsm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/error.h"
#include "terrain/tin/tin.h"
#include "terrain/tin/tin_surface.h"
#include "terrain/voids.h"

namespace swath::terrain {
namespace {

// A total order of the returns of one cell that does not depend on their order in the Block.
bool stands_over(const core::Block& b, std::uint32_t p, std::uint32_t q) {
  const auto key = [&](std::uint32_t r) {
    const float sigma = b.sigma_v.empty() ? 0.0f : b.sigma_v[r];
    return std::make_tuple(-b.z[r], b.x[r], b.y[r], std::isnan(sigma) ? std::numeric_limits<float>::infinity() : sigma);
  };
  return key(p) < key(q);
}

// The highest return per cell of `l`; -1 where there is none.
std::vector<std::int64_t> highest_returns(const core::Block& b, const std::vector<std::uint32_t>& rows, const core::Lattice& l) {
  std::vector<std::int64_t> top(l.size(), -1);
  for (const std::uint32_t r : rows) {
    const std::int64_t i = core::cell_index(b.x[r] + b.origin.x(), l.cell) - l.i0;
    const std::int64_t j = core::cell_index(b.y[r] + b.origin.y(), l.cell) - l.j0;
    if (i < 0 || j < 0 || i >= l.nx || j >= l.ny) continue;
    std::int64_t& held = top[l.at(static_cast<int>(i), static_cast<int>(j))];
    if (held < 0 || stands_over(b, r, static_cast<std::uint32_t>(held))) held = r;
  }
  return top;
}

}  // namespace

double halo(const DsmOptions& options) {
  const double patch = options.method == SurfaceMethod::spike_free ? spike_free_halo(options.spike_free) : 0.0;
  return options.max_gap.value + 2.0 * options.cell.value + patch;
}

std::vector<std::uint32_t> surface_rows(const core::Block& block) {
  std::vector<std::uint32_t> rows;
  for (size_t i = 0; i < block.size(); ++i) {
    const bool is_first = block.return_number.empty() || block.return_number[i] <= 1;
    if (is_first && core::is_usable(block, i) && std::isfinite(block.x[i]) && std::isfinite(block.y[i]) && std::isfinite(block.z[i]))
      rows.push_back(static_cast<std::uint32_t>(i));
  }
  return rows;
}

core::Grid dsm(const core::Block& block, const core::Lattice& window, const DsmOptions& options) {
  if (window.cell != options.cell.value) throw core::Error("the window's cell is not the option's", "terrain.dsm");
  const std::vector<std::uint32_t> rows = surface_rows(block);
  // Whole cells only: those within max_gap of a centre lie inside the halo.
  const int border = static_cast<int>(std::ceil(options.max_gap.value / window.cell)) + 1;
  const core::Lattice wide{window.cell, window.i0 - border, window.j0 - border, window.nx + 2 * border, window.ny + 2 * border};
  const std::vector<std::int64_t> top = highest_returns(block, rows, wide);

  core::Grid grid(window);
  grid.count = count_points(block, rows, window);
  const bool has_sigma = !block.sigma_v.empty();
  if (has_sigma) grid.sigma.assign(window.size(), std::numeric_limits<float>::quiet_NaN());
  const bool spike_free = options.method == SurfaceMethod::spike_free;
  for (int j = 0; j < window.ny && !spike_free; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const std::int64_t r = top[wide.at(i + border, j + border)];
      if (r < 0) continue;
      grid.height[window.at(i, j)] = static_cast<float>(block.origin.z() + block.z[r]);
      if (has_sigma) grid.sigma[window.at(i, j)] = block.sigma_v[r];
    }

  if (options.max_gap.value > 0.0) {
    std::vector<std::uint32_t> tops;
    if (spike_free)
      tops = spike_free_rows(block, rows, window, options.max_gap.value + 2.0 * window.cell, options.spike_free);
    else
      for (const std::int64_t r : top)
        if (r >= 0) tops.push_back(static_cast<std::uint32_t>(r));
    const Tin tin = triangulate(block, tops, 0.5 * options.max_gap.value);
    const std::vector<std::int32_t> triangle = triangles_at_centres(tin, block.origin, window);
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const size_t at = window.at(i, j);
        if ((!spike_free && grid.count[at] > 0) || triangle[at] < 0) continue;
        const double x = window.centre_x(i) - block.origin.x(), y = window.centre_y(j) - block.origin.y();
        grid.height[at] = static_cast<float>(block.origin.z() + height_in(tin, triangle[at], x, y));
        if (!has_sigma) continue;
        const auto [a, b, c] = tin.triangles[triangle[at]];
        const float s = tin.sigma_v[a] + tin.sigma_v[b] + tin.sigma_v[c];  // NaN where any is
        grid.sigma[at] = std::isnan(s) ? s : std::max({tin.sigma_v[a], tin.sigma_v[b], tin.sigma_v[c]});
      }
  }
  give_void_reasons(grid, block, rows, options.max_gap.value);
  return grid;
}

}  // namespace swath::terrain
