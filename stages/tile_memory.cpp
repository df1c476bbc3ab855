// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes measured 2026-11-22 and 2026-11-23 with tests/stages/memory_test.cpp, tiles of 100 to 1500 m, points 0.7 m and 3 m apart, where
// nothing else is said.
#include "stages/tile_memory.h"

namespace swath::stages {

/// Measured 62 and 63 bytes per cell of tile and halo, cells of 0.25 and 1 m.
TileMemory memory_of(const filters::SmrfOptions& o, double side) {
  return {16.0, {{"cell", o.cell.value, side + 2.0 * filters::halo(o), 66.0, 0.0, "window"}}};
}

TileMemory memory_of(const filters::PtdOptions&, double) { return {230.0}; }
TileMemory memory_of(const filters::RobustOptions&, double) { return {600.0}; }

// A square of filters/ground/patches.h with its margins is 4/3 of the halo wide. Measured 140 bytes per cell (pmf), 56 and 64 (csf,
// resolution 0.5 and 1 m).
constexpr double patch_per_halo = 4.0 / 3.0;
TileMemory memory_of(const filters::PmfOptions& o, double) {
  return {80.0, {{"cell_size", o.cell_size.value, patch_per_halo * filters::halo(o), 150.0, 0.0, "max_window_size"}}};
}
TileMemory memory_of(const filters::CsfOptions& o, double) {
  return {80.0, {{"resolution", o.resolution.value, patch_per_halo * filters::halo(o), 72.0}}};
}

/// Measured per cell: 38 bytes of the coarse surface, which goes on around the outermost points; then 135 of the fine one. Counted once
/// these are there: of the near points columns 31, nearest returns 24, heights 4; of the own ones evidence and chances 68.
TileMemory memory_of(const filters::GroundOptions& o, double side) {
  const double rim = filters::rim(o), fine = side + 2.0 * filters::near_halo(o);
  return {60.0,
          {{"", 1.0, side + 2.0 * filters::halo(o), 40.0, 0.0, "", rim}, {"", 1.0, fine, 55.0, 0.0, "", rim}, {"", 1.0, fine, 40.0}},
          1.0,
          68.0};
}

/// Starts and lowest points of the cells of one judgement, starts of the other's: 32 bytes per cell with both radii 0.5 m.
TileMemory memory_of(const filters::NoiseOptions& o, double side) {
  const double all = side + 2.0 * filters::halo(o);
  return {96.0, {{"low_radius", o.low_radius.value, all, 34.0}, {"radius", o.radius.value, all, 8.0}}};
}

/// Counted: two bins of the points (56), their mean distances and cells (12), the cubes' index (40). Measured, reach 0.8 m, window 1 m: 50
/// bytes per cell of a third of the window.
TileMemory memory_of(const filters::OutlierOptions& o, double side) {
  const double all = side + 2.0 * filters::halo(o);
  return {112.0, {{"window", filters::outlier_cell(o), all, 52.0}, {"reach", o.reach.value, all, 10.0}}};
}

/// Up to 177 bytes per point where none is ground. Counted: samples of four returns with their hashes, planes and rasters per cell of 1 m.
TileMemory memory_of(const filters::ClassifyOptions& o, double side) { return {180.0, {{"", 1.0, side + 2.0 * filters::halo(o), 165.0}}}; }

/// Counted: a bin of the points (28), their heights (8), what is in sorting; plots of 4 m with heights, sparse returns, planes, ranges.
TileMemory memory_of(const filters::WaterOptions& o, double side) { return {64.0, {{"", 4.0, side + 2.0 * filters::halo(o), 160.0}}}; }

/// As the terrain model's, and the seats of the points of a cell.
TileMemory memory_of(const terrain::KeyPointOptions&, double) { return {260.0}; }

}  // namespace swath::stages
