// SPDX-License-Identifier: GPL-3.0-or-later
// The survey in squares of its own, for methods whose answer hangs on all the points they are given: each square is worked with a margin
// around it, always from the same points, whatever tile it is met in.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/block.h"

namespace swath::filters {

struct Patching {
  double side = 100.0;   ///< m: squares on whole multiples of it in map coordinates
  double margin = 50.0;  ///< m: points this far around a square are worked with and keep the label that their own square gives them

  /// Metres of points around a tile that whole squares with their margins need.
  double halo() const;
};

/// One square [x0, x0 + side) x [y0, y0 + side) of map coordinates.
struct Patch {
  double x0 = 0, y0 = 0, side = 0;
  std::vector<std::uint32_t> rows;  ///< of the points within the margin, in the order of (x, y, z)

  bool owns(double x_map, double y_map) const { return x_map >= x0 && x_map < x0 + side && y_map >= y0 && y_map < y0 + side; }
};

/// Calls work(patch) for every square that holds a point among the first `own` for which takes_part holds; `rows` are points for which
/// it holds. What `work` sees does not depend on the tile or on the order of the points (but for points alike in x, y and z).
void for_each_patch(const core::Block& block, size_t own, const Patching& how, const std::function<bool(size_t)>& takes_part,
                    const std::function<void(const Patch&)>& work);

}  // namespace swath::filters
