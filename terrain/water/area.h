// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace swath::terrain {

/// An area with islands: whether a place lies in it, by the even-odd rule.
class Area {
 public:
  Area() = default;
  /// Rings of the outline and of islands, first vertex not repeated, m.
  explicit Area(const std::vector<std::vector<Eigen::Vector3d>>& rings);

  bool holds(double x, double y) const;
  bool box_meets(double x0, double y0, double x1, double y1) const { return x1 >= x0_ && x0 <= x1_ && y1 >= y0_ && y0 <= y1_; }

 private:
  struct Side {
    double x0, y0, x1, y1;  // y0 < y1
  };
  size_t row_of(double y) const;
  double x0_ = 0, y0_ = 0, x1_ = -1, y1_ = -1;
  std::vector<Side> sides_;
  std::vector<std::vector<std::uint32_t>> rows_;  // sides by strips of y, so that a place asks only a few
};

}  // namespace swath::terrain
