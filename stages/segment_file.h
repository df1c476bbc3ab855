// SPDX-License-Identifier: GPL-3.0-or-later
// A tile's segments of contours on disk.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "io/text/packed_column.h"
#include "stages/stage.h"
#include "terrain/contours/contours.h"

namespace swath::stages {

/// The segments of one level in the file of a tile.
struct LevelSegments {
  std::filesystem::path file;
  std::uint64_t first_byte = 0, count = 0;
  io::PackedHead packed;
  size_t bytes() const { return count * sizeof(terrain::Segment); }
};

/// `segments`: in order of their levels, as terrain::trace() gives them.
void write_segments(const std::filesystem::path& folder, TileKey key, const std::vector<terrain::Segment>& segments);

/// Adds the levels of a tile's file. Throws core::SystemError where the file is not as it was written.
void add_levels(const std::filesystem::path& folder, TileKey key, std::map<std::int64_t, std::vector<LevelSegments>>& levels);

/// Appends the segments; throws as above.
void read_segments(const LevelSegments& from, std::vector<terrain::Segment>& segments);

}  // namespace swath::stages
