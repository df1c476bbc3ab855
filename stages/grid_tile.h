// SPDX-License-Identifier: GPL-3.0-or-later
// One tile's grid as an intermediate file of a stage's folder.
#pragma once

#include <filesystem>
#include <vector>

#include "core/grid.h"
#include "io/raster/grid_file.h"
#include "stages/stage.h"

namespace swath::stages {

/// The file of a tile's grid in a stage's folder.
std::filesystem::path grid_file(const std::filesystem::path& folder, TileKey key);

void write_grid_tile(const std::filesystem::path& folder, TileKey key, const core::Grid& grid);

/// The grid that a tile's parts made under the tile's key in folders of their own, as the tile's; nothing where none made one.
void join_grid_parts(const std::filesystem::path& folder, TileKey key, const std::vector<std::filesystem::path>& parts,
                     const core::Lattice& lattice);

}  // namespace swath::stages
