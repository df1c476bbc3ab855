// SPDX-License-Identifier: GPL-3.0-or-later
// The segments of contour lines between tiles and merge: one file per tile in the work folder, packed by level.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/text/packed_column.h"
#include "stages/stage.h"
#include "terrain/contours/contours.h"

namespace swath::stages {

/// \param segments Of a tile, sorted by level.
/// \throws core::SystemError where the file cannot be written.
void write_segments(const std::filesystem::path& folder, TileKey key, const std::vector<terrain::Segment>& segments);

/// What the tiles have written, level by level from the lowest.
class LevelSegments {
 public:
  /// \throws core::SystemError where a file is absent or cut short; so does `next`.
  LevelSegments(std::filesystem::path folder, const std::vector<TileKey>& tiles);

  /// Bytes of each level's segments once they are read, the largest level first.
  std::vector<size_t> bytes() const;
  bool done() const { return next_ == stretches_.end(); }
  /// The segments of the next level, of all tiles.
  std::vector<terrain::Segment> next();

 private:
  struct Head {
    std::int64_t level = 0;
    std::uint64_t count = 0;
    io::PackedHead packed;
  };
  struct Stretch {
    TileKey key;
    std::uint64_t first_byte;
    Head head;
  };
  friend void write_segments(const std::filesystem::path&, TileKey, const std::vector<terrain::Segment>&);

  std::filesystem::path folder_;
  std::map<std::int64_t, std::vector<Stretch>> stretches_;
  std::map<std::int64_t, std::vector<Stretch>>::const_iterator next_;
};

}  // namespace swath::stages
