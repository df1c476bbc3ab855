// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/map_overview.h"

#include <algorithm>

#include "core/floor_div.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "stages/grid_tile.h"

namespace swath::stages {

namespace {

/// The part with heights, and a rim of a cell.
core::Grid cropped(const core::Grid& g) {
  int west = g.lattice.nx, east = -1, south = g.lattice.ny, north = -1;
  for (int j = 0; j < g.lattice.ny; ++j)
    for (int i = 0; i < g.lattice.nx; ++i)
      if (g.reason[g.lattice.at(i, j)] == core::Void::none)
        west = std::min(west, i), east = std::max(east, i), south = std::min(south, j), north = std::max(north, j);
  if (east < 0) return g;
  west = std::max(0, west - 1), south = std::max(0, south - 1);
  east = std::min(g.lattice.nx - 1, east + 1), north = std::min(g.lattice.ny - 1, north + 1);
  core::Grid out(core::Lattice{g.lattice.cell, g.lattice.i0 + west, g.lattice.j0 + south, east - west + 1, north - south + 1});
  out.count.assign(out.lattice.size(), 0);
  for (int j = 0; j < out.lattice.ny; ++j)
    for (int i = 0; i < out.lattice.nx; ++i) {
      const size_t to = out.lattice.at(i, j), from = g.lattice.at(i + west, j + south);
      out.height[to] = g.height[from], out.reason[to] = g.reason[from], out.count[to] = g.count[from];
    }
  return out;
}

}  // namespace

core::Grid overview_of(const Context& context, const std::filesystem::path& folder, const std::vector<TileKey>& tiles, double cell,
                       int most) {
  if (tiles.empty()) return core::Grid();
  Box box = context.box_of(tiles[0]);
  for (const TileKey key : tiles) {
    const Box b = context.box_of(key);
    box = {std::min(box.x0, b.x0), std::min(box.y0, b.y0), std::max(box.x1, b.x1), std::max(box.y1, b.y1)};
  }
  const core::Lattice fine = core::lattice_of(cell, box.x0, box.y0, box.x1, box.y1);
  const int factor = std::max(1, (std::max(fine.nx, fine.ny) + most - 1) / most);
  core::Grid out(core::lattice_of(cell * factor, box.x0, box.y0, box.x1, box.y1));
  std::vector<double> sums(out.lattice.size(), 0.0);
  out.count.assign(out.lattice.size(), 0);
  for (const TileKey key : tiles) {
    if (!std::filesystem::exists(grid_file(folder, key))) continue;
    const core::Grid g = io::read_grid_file(grid_file(folder, key));
    for (int j = 0; j < g.lattice.ny; ++j)
      for (int i = 0; i < g.lattice.nx; ++i) {
        const size_t from = g.lattice.at(i, j);
        if (g.reason[from] != core::Void::none) continue;
        const std::int64_t u = core::floor_div(g.lattice.i0 + i, factor) - out.lattice.i0,
                           v = core::floor_div(g.lattice.j0 + j, factor) - out.lattice.j0;
        if (u < 0 || v < 0 || u >= out.lattice.nx || v >= out.lattice.ny) continue;
        const size_t to = out.lattice.at(static_cast<int>(u), static_cast<int>(v));
        sums[to] += static_cast<double>(g.height[from]);
        ++out.count[to];
      }
  }
  for (size_t c = 0; c < sums.size(); ++c)
    if (out.count[c] > 0) {
      out.height[c] = static_cast<float>(sums[c] / out.count[c]);
      out.reason[c] = core::Void::none;
    }
  return cropped(out);
}

void write_picture(const Context& context, const std::string& name, const core::Picture& picture) {
  const std::filesystem::path file = context.output / (name + ".png");
  io::write_text_file(file, io::png_bytes(picture, file));
}

}  // namespace swath::stages
