// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a crowded column (a wall, a mast, many returns at one place) so that few of them are looked at to find the nearest.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "filters/bins.h"

namespace swath::filters {

/// A balanced k-d tree with the box of each node (Friedman, Bentley & Finkel 1977). 24 bytes per point and 64 per node of up to 16 points;
/// points at one place are one node however many they are.
class ColumnTree {
 public:
  explicit ColumnTree(std::span<const Bins::Point> points);

  /// Offers the squared distances from p to the points, but for those that are not below least.worst(). Rounding keeps the order of box and
  /// point: no point that offering all would take is left out.
  template <class Least>
  void offer(const Bins::Point& p, Least& least) const {
    if (!nodes_.empty()) offer(0, p, least);
  }

 private:
  struct Node {
    Bins::Point low, high;
    std::uint32_t first = 0, end = 0;  ///< its points
    std::uint32_t children = 0;        ///< two, one after the other; 0: none
  };

  static double beyond(double v, double low, double high) { return std::max({0.0, low - v, v - high}); }
  static double squared_distance(const Node& n, const Bins::Point& p) {
    const double dx = beyond(p.x, n.low.x, n.high.x), dy = beyond(p.y, n.low.y, n.high.y), dz = beyond(p.z, n.low.z, n.high.z);
    return dx * dx + dy * dy + dz * dz;
  }

  template <class Least>
  void offer(std::uint32_t at, const Bins::Point& p, Least& least) const {
    const Node& n = nodes_[at];
    const double nearest = squared_distance(n, p);
    if (n.children == 0) {
      for (std::uint32_t k = n.first; k < n.end && nearest < least.worst(); ++k) {
        const double dx = points_[k].x - p.x, dy = points_[k].y - p.y, dz = points_[k].z - p.z;
        least.offer(dx * dx + dy * dy + dz * dz);
      }
      return;
    }
    if (!(nearest < least.worst())) return;
    const bool second = squared_distance(nodes_[n.children + 1], p) < squared_distance(nodes_[n.children], p);
    offer(n.children + (second ? 1 : 0), p, least);
    offer(n.children + (second ? 0 : 1), p, least);
  }

  /// Fills the node, whose points are known, and makes those below it.
  void build(std::uint32_t at);

  std::vector<Bins::Point> points_;
  std::vector<Node> nodes_;
};

}  // namespace swath::filters
