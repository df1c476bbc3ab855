// SPDX-License-Identifier: GPL-3.0-or-later
// Indices of a cloud's tiles: a virtual point cloud (.vpc) for viewers, a GeoPackage for maps and deliveries.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/block.h"
#include "io/las/las_header.h"

namespace swath::io {

/// What is known of a tile's points, gathered block by block.
struct TileFacts {
  static constexpr double none = std::numeric_limits<double>::infinity();
  std::uint64_t points = 0, first_returns = 0, cells = 0;               ///< cells of `cell` metres with a point
  double low[3] = {none, none, none}, high[3] = {-none, -none, -none};  ///< map metres
  double first_time = none, last_time = -none;                          ///< GPS time, s; infinite where unknown
  std::uint64_t classes[256] = {};

  static constexpr double cell = 2.0;
  /// Points per square metre of the cells with points; 0 without any.
  double density() const { return cells > 0 ? static_cast<double>(points) / (static_cast<double>(cells) * cell * cell) : 0.0; }
};

/// Gathers the facts of a tile; origin and coordinates of the blocks are in metres.
class TileFactsOf {
 public:
  void add(const core::Block& block);
  TileFacts facts() const;

 private:
  TileFacts facts_;
  std::unordered_set<std::uint64_t> cells_;
};

struct IndexedTile {
  std::string name;  ///< of the file beside the index
  TileFacts facts;
};

struct TileIndex {
  std::vector<IndexedTile> tiles;
  std::string crs;
  double unit = 1.0, vertical_unit = 1.0;  ///< metres per unit of the CRS
  std::string date;                        ///< "2024-06-07T00:00:00Z", of tiles whose times are unknown
};

/// A STAC 1.0 ItemCollection with the extensions pointcloud and projection: per tile its box in WGS84 and in the CRS, times, number,
/// density, heights and classes, and the fields of `header` (pc:schemas). Throws core::Error where the CRS has no way to WGS84.
void write_vpc(const std::filesystem::path& file, const TileIndex& index, const LasHeader& header);

/// Layer `tiles` of a GeoPackage: the box of each tile's points, with number, first returns, density, heights, times and classes ("2: 1200,
/// 5: 88").
void write_tile_layer(const std::filesystem::path& file, const TileIndex& index);

}  // namespace swath::io
