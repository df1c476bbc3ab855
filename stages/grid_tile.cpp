// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/grid_tile.h"

#include "core/paste.h"

namespace swath::stages {

std::filesystem::path piece_file(const std::filesystem::path& folder, TileKey key, const char* ending) {
  return folder / (std::to_string(key.ix) + "_" + std::to_string(key.iy) + "." + ending);
}

void write_grid_tile(const std::filesystem::path& folder, TileKey key, const core::Grid& grid) {
  std::filesystem::create_directories(folder);
  io::write_grid_file(grid_file(folder, key), grid);
}

void join_grid_parts(const std::filesystem::path& folder, TileKey key, const std::vector<std::filesystem::path>& parts,
                     const core::Lattice& lattice) {
  core::Grid whole(lattice);
  bool any = false;
  for (const std::filesystem::path& part : parts)
    if (const std::filesystem::path file = grid_file(part, key); std::filesystem::exists(file)) {
      core::paste(io::read_grid_file(file), whole);
      any = true;
    }
  if (any) write_grid_tile(folder, key, whole);
}

}  // namespace swath::stages
