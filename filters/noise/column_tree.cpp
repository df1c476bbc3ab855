// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/column_tree.h"

namespace swath::filters {
namespace {

constexpr std::uint32_t points_of_leaf = 16;

}  // namespace

ColumnTree::ColumnTree(std::span<const Bins::Point> points) : points_(points.begin(), points.end()) {
  if (points_.empty()) return;
  nodes_.push_back({{}, {}, 0, static_cast<std::uint32_t>(points_.size()), 0});
  build(0);
}

void ColumnTree::build(std::uint32_t at) {
  const std::uint32_t first = nodes_[at].first, end = nodes_[at].end;
  Bins::Point low = points_[first], high = low;
  for (std::uint32_t k = first; k < end; ++k) {
    const Bins::Point& p = points_[k];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  nodes_[at].low = low, nodes_[at].high = high;
  const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z, widest = std::max({x, y, z});
  if (end - first <= points_of_leaf || !(widest > 0.0)) return;
  const auto coordinate = widest == x ? &Bins::Point::x : widest == y ? &Bins::Point::y : &Bins::Point::z;
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + end,
                   [coordinate](const Bins::Point& a, const Bins::Point& b) { return a.*coordinate < b.*coordinate; });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[at].children = children;
  nodes_.push_back({{}, {}, first, middle, 0});
  nodes_.push_back({{}, {}, middle, end, 0});
  build(children);
  build(children + 1);
}

}  // namespace swath::filters
