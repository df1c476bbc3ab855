// SPDX-License-Identifier: GPL-3.0-or-later
// Grey morphology on rasters with holes.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace swath::filters {

/// A raster of plain numbers, row-major, i fastest. NaN marks a cell without value.
struct Raster {
  int nx = 0, ny = 0;
  std::vector<float> value;

  Raster() = default;
  Raster(int width, int height, float fill)
      : nx(width), ny(height), value(static_cast<size_t>(width) * static_cast<size_t>(height), fill) {}
  size_t at(int i, int j) const { return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i); }
  bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < nx && j < ny; }
};

/// Opening by the disk of cells with i^2 + j^2 <= radius^2. Cells without value and the outside take no part: each cell with a value gets
/// the largest, over all disks with centre in the raster that contain it, of the smallest value in the disk; cells without keep NaN.
/// Support: 2 radius cells. The raster must reach `radius` cells beyond its outermost values, or disks with centres outside are missed.
Raster open_disk(const Raster& surface, int radius);

/// Part of a row of an opening: take(j, i, values, n) gets those of cells (i, j) to (i + n - 1, j).
using OpenedRow = std::function<void(int j, int i, const float* values, int n)>;
/// The same, given row by row; every cell comes once.
void open_disk(const Raster& surface, int radius, const OpenedRow& take);

/// Closing: the opening of the surface turned upside down.
Raster close_disk(const Raster& surface, int radius);

}  // namespace swath::filters
