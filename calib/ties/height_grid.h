// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of the last returns of each flight line on one lattice: surfaces that can be laid over one another.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "calib/ties/local_points.h"

namespace swath::calib {

/// A rectangle of mean heights, row by row from the south-west; NaN where there is none.
struct Raster {
  int nx = 0, ny = 0;
  std::vector<float> z;  ///< m
};

/// 16 x 16 cells that hold anything, and one return among them.
struct HeightTile {
  static constexpr int side = 16;
  std::int32_t i = 0, j = 0;  ///< number of the tile east and north
  float base = 0.0f;          ///< heights count from here, m
  std::array<float, side * side> sum{};
  std::array<std::uint16_t, side * side> n{};
  double time = 0.0;  ///< of the sample, as recorded, s
  Return sample;
};

/// What one line saw looking one way: scanners that turn about the nadir (conical, palmer) see a place twice, ahead and behind.
struct HeightView {
  int line = 0;
  bool astern = false;
  std::vector<HeightTile> tiles;
  std::unordered_map<std::uint64_t, std::uint32_t> number;  ///< of the tile at (i, j)

  const HeightTile* tile(std::int32_t i, std::int32_t j) const;
  /// Means over factor x factor cells; (i, j) the south-west one, counted in such blocks from the frame's origin.
  Raster raster(std::int64_t i, std::int64_t j, int nx, int ny, int factor) const;
};

struct HeightGrids {
  double cell = 0.0;  ///< m
  std::vector<HeightView> views;
  std::uint64_t returns = 0;  ///< last returns in them
};

/// Reads the stream once. The cell is `smallest_cell` or wider, so that a cell of one line holds two returns on average; it is doubled
/// whenever all views together would exceed `most_cells` (6 bytes each).
HeightGrids height_grids(const ShotStream& stream, LocalPoints& points, double smallest_cell, std::uint64_t most_cells);

}  // namespace swath::calib
