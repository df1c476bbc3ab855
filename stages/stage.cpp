// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stage.h"

#include <cmath>

namespace swath::stages {

std::string_view name_of(Grain g) {
  static constexpr std::string_view names[] = {"survey", "strip", "tile", "merge"};
  return names[static_cast<size_t>(g)];
}

core::Lattice lattice_in(double cell, const Box& box) {
  // Centre (i + 0.5) cell in [x0, x1)  <=>  i in [x0/cell - 0.5, x1/cell - 0.5).
  const auto first = [cell](double edge) { return static_cast<std::int64_t>(std::ceil(edge / cell - 0.5)); };
  const std::int64_t i0 = first(box.x0), j0 = first(box.y0);
  return {cell, i0, j0, static_cast<int>(first(box.x1) - i0), static_cast<int>(first(box.y1) - j0)};
}

std::vector<Raster> window_of(const Context& context, Product product, int others) {
  if (!context.grids || !context.grids->has(product)) return {};
  constexpr double cell_bytes = 13.0;  // of a core::Grid with sigma and count
  // While a tile is read its file, its grid and the window are there.
  return {{"", context.grids->cell(product), context.tile_side, cell_bytes * (3.0 + others)}};
}

std::filesystem::path Context::made(const std::filesystem::path& name) const {
  for (auto folder = earlier.rbegin(); folder != earlier.rend(); ++folder)
    if (std::filesystem::exists(*folder / name)) return *folder / name;
  return {};
}

std::string Context::label(TileKey k) const {
  const auto part = [this](int i) {
    const double corner = i * (tile_side / unit);
    // Rounded corners of tiles that are wider than a unit stay apart.
    if (corner == std::round(corner) || (unit != 1.0 && tile_side >= 2.0 * unit)) return std::to_string(std::llround(corner));
    return std::to_string(std::llround(corner * 1000)) + "mm";
  };
  return part(k.ix) + "_" + part(k.iy);
}

}  // namespace swath::stages
