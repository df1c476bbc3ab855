// SPDX-License-Identifier: GPL-3.0-or-later
// The one box that all coordinates of a run are held against.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "core/block.h"
#include "core/report.h"

namespace swath::core {

/// A box of map metres, half open.
struct Box {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  Box grown(double by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
  bool holds(double x, double y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  double area() const { return (x1 - x0) * (y1 - y0); }
};

/// Where the points of a run may lie: map metres.
struct Area {
  static constexpr double none = std::numeric_limits<double>::infinity();
  Box box{-none, -none, none, none};
  double lowest = -12e3, highest = 20e3;  ///< by default between the deepest sea floor and what flies with a laser
  bool has_height(double z) const { return z >= lowest && z <= highest; }
};

/// Leaves out the points of a block (origin and coordinates in metres) that lie outside the area or beyond its heights, counted with
/// examples. `name`: of their source.
void keep_in_area(const Area& area, Block& block, const std::string& name, Tally& tally);

/// Leaves out the rows of which `is_out`, counted as `what` with their place.
void leave_out(Block& block, const std::function<bool(size_t)>& is_out, const std::string& what, const std::string& name, Tally& tally);

}  // namespace swath::core
