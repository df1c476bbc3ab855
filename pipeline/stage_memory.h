// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage takes of memory for tiles at work, and into how many parts a tile is cut so that it fits.
#pragma once

#include <map>
#include <mutex>

#include "pipeline/tile_groups.h"
#include "pipeline/tile_store.h"

namespace swath::pipeline {

/// The columns that a tile's work with the stage reads or gives.
core::ColumnSet columns_of_tiles(const stages::Stage& stage);

/// Is one of the products made of triangles, which reach into tiles without points?
bool has_surface(const std::vector<stages::Product>& products);

/// Does a tile's work with the stage depend on points?
bool reads_points(const stages::Stage& stage);

/// Points in small squares of tiles, counted once they are asked for.
class SquareCounts {
 public:
  static constexpr int across = 64;  ///< squares along a side of a tile
  explicit SquareCounts(const TileStore& store) : store_(store) {}
  const std::vector<std::uint32_t>& of(TileKey key);

 private:
  const TileStore& store_;
  std::map<TileKey, std::vector<std::uint32_t>> counts_;
};

class StageMemory {
 public:
  StageMemory(const TileStore& store, const stages::Stage& stage, const stages::Context& context);

  /// Of tiles that are worked on as one.
  TileGroup of(std::vector<TileKey> tiles) const;
  /// The tile in as few parts as fit into `budget` bytes; where none fit, or the stage does not divide tiles, the least that it takes.
  TileGroup cut(TileGroup group, std::uint64_t budget, SquareCounts& counts) const;

 private:
  class Around;
  /// Points that are read at once, those that the stage's own bytes are for, its own of them, and all within the halo.
  struct Points {
    double rows, near, own, all;
  };
  double needed(const Points& points, const stages::Box& box) const;
  double points_counted(const Points& points, double side, double share) const;

  const TileStore& store_;
  const stages::Stage& stage_;
  const stages::Context& context_;
  mutable stages::Context square_;  ///< with the side of what is worked on
  double row_bytes_ = 0.0, given_bytes_ = 0.0;
};

}  // namespace swath::pipeline
