// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/map_overview.h"

#include <algorithm>
#include <limits>

#include "core/floor_div.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "stages/grid_tile.h"

namespace swath::stages {

namespace {

constexpr std::int64_t far = std::numeric_limits<std::int64_t>::max();

/// Cells [i0, i1) x [j0, j1).
struct Cells {
  std::int64_t i0 = far, j0 = far, i1 = -far, j1 = -far;
  void add(std::int64_t i, std::int64_t j, int nx, int ny) {
    i0 = std::min(i0, i), i1 = std::max(i1, i + nx), j0 = std::min(j0, j), j1 = std::max(j1, j + ny);
  }
  bool empty() const { return i1 <= i0 || j1 <= j0; }
};

/// Around the cells with a height of the tiles' grids; where there are none, around the grids.
Cells occupied_by(const std::filesystem::path& folder, const std::vector<TileKey>& tiles) {
  Cells grids, heights;
  for (const TileKey key : tiles) {
    if (!std::filesystem::exists(grid_file(folder, key))) continue;
    const core::Grid g = io::read_grid_file(grid_file(folder, key));
    grids.add(g.lattice.i0, g.lattice.j0, g.lattice.nx, g.lattice.ny);
    for (int j = 0; j < g.lattice.ny; ++j)
      for (int i = 0; i < g.lattice.nx; ++i)
        if (g.reason[g.lattice.at(i, j)] == core::Void::none) heights.add(g.lattice.i0 + i, g.lattice.j0 + j, 1, 1);
  }
  return heights.empty() ? grids : heights;
}

}  // namespace

core::Grid overview_of(const std::filesystem::path& folder, const std::vector<TileKey>& tiles, double cell, int most) {
  const Cells there = occupied_by(folder, tiles);
  if (there.empty()) return core::Grid();
  const std::int64_t factor = std::max<std::int64_t>(1, (std::max(there.i1 - there.i0, there.j1 - there.j0) + most - 1) / most);
  const std::int64_t u0 = core::floor_div(there.i0, factor), v0 = core::floor_div(there.j0, factor);
  core::Grid out(core::Lattice{cell * static_cast<double>(factor), u0, v0, static_cast<int>(core::floor_div(there.i1 - 1, factor) - u0 + 1),
                               static_cast<int>(core::floor_div(there.j1 - 1, factor) - v0 + 1)});
  std::vector<double> sums(out.lattice.size(), 0.0);
  out.count.assign(out.lattice.size(), 0);
  for (const TileKey key : tiles) {
    if (!std::filesystem::exists(grid_file(folder, key))) continue;
    const core::Grid g = io::read_grid_file(grid_file(folder, key));
    for (int j = 0; j < g.lattice.ny; ++j)
      for (int i = 0; i < g.lattice.nx; ++i) {
        const size_t from = g.lattice.at(i, j);
        if (g.reason[from] != core::Void::none) continue;
        const size_t to = out.lattice.at(static_cast<int>(core::floor_div(g.lattice.i0 + i, factor) - u0),
                                         static_cast<int>(core::floor_div(g.lattice.j0 + j, factor) - v0));
        sums[to] += static_cast<double>(g.height[from]);
        ++out.count[to];
      }
  }
  for (size_t c = 0; c < sums.size(); ++c)
    if (out.count[c] > 0) {
      out.height[c] = static_cast<float>(sums[c] / out.count[c]);
      out.reason[c] = core::Void::none;
    }
  return out;
}

void write_picture(const Context& context, const std::string& name, const core::Picture& picture) {
  const std::filesystem::path file = context.output / (name + ".png");
  io::write_text_file(file, io::png_bytes(picture, file));
}

}  // namespace swath::stages
