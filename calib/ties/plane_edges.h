// SPDX-License-Identifier: GPL-3.0-or-later
// Where the returns of a plane end.
#pragma once

#include <Eigen/Core>
#include <set>
#include <utility>
#include <vector>

namespace swath::calib {

/// Squares of a plane that hold points; a square without any counts too where six of its eight neighbours do.
class Occupied {
 public:
  /// `points` along the plane's axes, m; `cell` m.
  Occupied(const std::vector<Eigen::Vector2d>& points, double cell);
  /// Is the plane occupied at a place and in eight directions at `margin` from it?
  bool surrounds(const Eigen::Vector2d& p, double margin) const;

 private:
  std::pair<int, int> index(const Eigen::Vector2d& p) const;
  int neighbours(int i, int j) const;
  double cell_;
  std::set<std::pair<int, int>> cells_;
};

}  // namespace swath::calib
