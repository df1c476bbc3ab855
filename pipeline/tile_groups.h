// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles that a stage works on as one: what they have around them is read and worked through once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "stages/stage.h"

namespace swath::pipeline {

using stages::TileKey;

/// Tiles from `low` to `high`, both in it.
struct TileBox {
  TileKey low, high;
  TileBox(TileKey l, TileKey h) : low(l), high(h) {}
  explicit TileBox(const std::vector<TileKey>& tiles);
  bool holds(TileKey k) const { return k.ix >= low.ix && k.ix <= high.ix && k.iy >= low.iy && k.iy <= high.iy; }
  /// In map metres, of tiles with such a side.
  stages::Box metres(double side) const { return {low.ix * side, low.iy * side, (high.ix + 1) * side, (high.iy + 1) * side}; }
  int across() const { return high.ix - low.ix + 1; }
  int up() const { return high.iy - low.iy + 1; }
};

/// One of n x n squares of a tile, n a power of 2: the number `i` of them from the west, `j` from the south.
struct TilePart {
  TileKey tile;
  int n = 1, i = 0, j = 0;
  /// The square that a point of the tile (map metres) lies in.
  static std::pair<int, int> square_of(TileKey tile, int n, double x, double y, double side);
  /// Is a point of the tile one of this part's?
  bool holds(double x, double y, double side) const { return square_of(tile, n, x, y, side) == std::pair(i, j); }
  stages::Box metres(double side) const;
};

struct TileGroup {
  std::vector<TileKey> tiles;   ///< all there are in their box, ascending
  std::uint64_t own = 0;        ///< points of the tiles
  std::uint64_t with_halo = 0;  ///< points to work on, those around with them
  std::uint64_t bytes = 0;      ///< needed
  int parts = 1;                ///< along a side of the tile, which is worked on part by part where it is more than 1
};

/// Counts own, with_halo and bytes of the tiles.
using Measure = std::function<TileGroup(std::vector<TileKey>)>;

/// A group for each tile.
std::vector<TileGroup> single_tiles(const std::vector<TileKey>& tiles, const Measure& measure);

/// The tiles in boxes so that the thread with most to do has least, where the largest of `threads` groups fit into `budget` bytes and none
/// has more than most_points (a kill must not cost too much); a group for each tile where nothing else does.
std::vector<TileGroup> joined_tiles(const std::vector<TileKey>& tiles, int threads, std::uint64_t budget, const Measure& measure);

constexpr std::uint64_t most_points = 20'000'000;  ///< of a group of several tiles

/// The same groups again: the tiles of each box.
std::vector<TileGroup> grouped_tiles(const std::vector<TileKey>& tiles, const std::vector<TileBox>& boxes, const Measure& measure);

/// The boxes of groups in a file, and back; none where there is no such file.
void write_boxes(const std::filesystem::path& file, const std::vector<TileGroup>& groups);
std::vector<TileBox> read_boxes(const std::filesystem::path& file);

/// Needed at once by the largest of `threads` groups.
std::uint64_t most_bytes(const std::vector<TileGroup>& groups, int threads);

}  // namespace swath::pipeline
