// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/floor_div.h"

namespace swath::core {

/// Cells of one size whose corners lie on whole multiples of the cell (the whole survey shares one lattice).
/// Cell (i, j) spans [i, i+1) x [j, j+1) times `cell` in map coordinates; its height stands at its centre.
struct Lattice {
  double cell = 1.0;            ///< CRS units (metres inside a run)
  std::int64_t i0 = 0, j0 = 0;  ///< index of the south-west cell
  int nx = 0, ny = 0;

  size_t size() const { return static_cast<size_t>(nx) * static_cast<size_t>(ny); }
  double west() const { return static_cast<double>(i0) * cell; }
  double south() const { return static_cast<double>(j0) * cell; }
  double east() const { return static_cast<double>(i0 + nx) * cell; }
  double north() const { return static_cast<double>(j0 + ny) * cell; }
  double centre_x(int i) const { return (static_cast<double>(i0 + i) + 0.5) * cell; }
  double centre_y(int j) const { return (static_cast<double>(j0 + j) + 0.5) * cell; }
  size_t at(int i, int j) const { return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i); }
  bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < nx && j < ny; }
  bool operator==(const Lattice&) const = default;
};

/// Index of the cell that holds map coordinate v.
inline std::int64_t cell_index(double v, double cell) { return floor_of(v / cell); }

/// The smallest lattice that holds the box [x0, x1) x [y0, y1) of map coordinates.
inline Lattice lattice_of(double cell, double x0, double y0, double x1, double y1) {
  const std::int64_t i0 = cell_index(x0, cell);
  const std::int64_t j0 = cell_index(y0, cell);
  const auto i1 = static_cast<std::int64_t>(std::ceil(x1 / cell));
  const auto j1 = static_cast<std::int64_t>(std::ceil(y1 / cell));
  return {cell, i0, j0, static_cast<int>(i1 - i0), static_cast<int>(j1 - j0)};
}

/// Why a cell has no height.
enum class Void : std::uint8_t { none = 0, no_data = 1, long_edge = 2, water = 3, never_seen = 4 };

/// A surface on a lattice; row-major from the south-west, i runs fastest. NaN height where reason is not none.
struct Grid {
  Lattice lattice;
  std::vector<float> height;         ///< m, in the vertical reference of the CRS
  std::vector<float> sigma;          ///< m; may be empty
  std::vector<std::uint32_t> count;  ///< points in the cell; may be empty
  std::vector<Void> reason;

  explicit Grid(Lattice l = {}) : lattice(l), height(l.size(), std::numeric_limits<float>::quiet_NaN()), reason(l.size(), Void::no_data) {}
};

}  // namespace swath::core
