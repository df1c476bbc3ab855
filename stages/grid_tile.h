// SPDX-License-Identifier: GPL-3.0-or-later
// One tile's grid as an intermediate file of a stage's folder.
#pragma once

#include <filesystem>
#include <vector>

#include "core/grid.h"
#include "stages/stage.h"

namespace swath::stages {

/// The file of a tile's grid in a stage's folder.
std::filesystem::path grid_file(const std::filesystem::path& folder, TileKey key);

/// Writes the grid whole or not at all, in the machine's byte order.
void write_grid_tile(const std::filesystem::path& folder, TileKey key, const core::Grid& grid);

/// Reads it back; throws core::Error where it is damaged.
core::Grid read_grid_tile(const std::filesystem::path& file);

/// The grid that a tile's parts made under the tile's key in folders of their own, as the tile's; nothing where none made one.
void join_grid_parts(const std::filesystem::path& folder, TileKey key, const std::vector<std::filesystem::path>& parts,
                     const core::Lattice& lattice);

/// An intermediate file of a stage is not as long as it must be: throws core::Error.
[[noreturn]] void cut_short(const std::filesystem::path& file);

/// The part of a tile's grid that lies in `window`'s lattice is copied there.
void paste(const core::Grid& tile, core::Grid& window);

}  // namespace swath::stages
