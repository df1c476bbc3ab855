// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "stages/stage.h"

namespace swath::pipeline {

/// A tile as the headers of the survey's clouds have it before their points are read.
struct FullTile {
  stages::TileKey key;
  std::uint64_t points = 0;  ///< at least
  std::string file;
};

/// The tile that must hold most: a file's points lie in the tiles of its box, and one of these holds no fewer than their share. Nothing
/// where no file lies in the run's own coordinates.
std::optional<FullTile> fullest_tile(const stages::Context& context);

/// Points by tile where each file's lie evenly over its box; of files that fullest_tile() knows.
std::map<stages::TileKey, std::uint64_t> even_tiles(const stages::Context& context);

}  // namespace swath::pipeline
