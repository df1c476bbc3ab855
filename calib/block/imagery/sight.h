// SPDX-License-Identifier: GPL-3.0-or-later
// What stands between a place and a camera. Map coordinates, m; the ray is straight on the map: its bend is 1 mm over 100 m, 2 cm over 500
// m.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::calib {

/// The highest point of each cell: of those that are neither noise nor withheld nor of a wire.
core::Grid tops_of(const core::Block& block, double cell);

/// Columns up to a surface's heights hide what is behind them, and what is below: walls have few points, and crowns let no camera through.
/// What is hidden depends on the columns within `reach` alone, not on where a tile ends.
class Sight {
 public:
  /// The grid must outlive this. Cells without a height hide nothing.
  Sight(const core::Grid& tops, double reach);

  /// Does a column hide the place from the camera? Those do not that the ray passes less than `clearance` above the place, so that level
  /// ground does not hide itself, nor those farther off than the reach. A camera below the place is not looked for.
  bool is_hidden(const Eigen::Vector3d& place, const Eigen::Vector3d& camera, double clearance) const;

 private:
  void find_tops();
  /// The highest column within the reach of a cell, m.
  double top_near(std::int64_t i, std::int64_t j) const;

  const core::Grid& grid_;
  double reach_;
  static constexpr int square_ = 16;  // columns along a side of a square
  int squares_x_ = 0, squares_y_ = 0;
  std::vector<double> tops_;  // per square, of all within its reach
};

}  // namespace swath::calib
