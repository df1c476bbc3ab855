// SPDX-License-Identifier: GPL-3.0-or-later
// Small maps of what the tiles of a survey have left.
#pragma once

#include <filesystem>
#include <vector>

#include "core/grid.h"
#include "core/picture.h"
#include "stages/stage.h"

namespace swath::stages {

constexpr int map_side = 800;  ///< cells of an overview, at most

/// The tiles' grids of `cell` metres in `folder` (stages/grid_tile.h), averaged by whole blocks to at most `most` cells a side, and one.
/// Cells without a height count for nothing; the map is around those with one, so that a small cloud fills it. Memory does not grow with
/// the survey. The lattice's indices are those of the blocks.
core::Grid overview_of(const std::filesystem::path& folder, const std::vector<TileKey>& tiles, double cell, int most = map_side);

/// A picture as NAME.png among the stage's products.
void write_picture(const Context& context, const std::string& name, const core::Picture& picture);

}  // namespace swath::stages
