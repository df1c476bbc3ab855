// SPDX-License-Identifier: GPL-3.0-or-later
// A height grid as the surface of triangles that contours are traced on, of any extent: read page by page.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "core/grid.h"

namespace swath::terrain {

/// Every square of four cell centres is cut into four triangles at its middle, whose height is the mean of the four. A square with a void
/// corner is void. Not for several threads at once: it keeps the pages it has read.
class Facets {
 public:
  /// Gives the heights of a window, NaN where there are none.
  using Load = std::function<core::Grid(const core::Lattice&)>;
  /// `bytes`: of heights held at a time, at least one page.
  Facets(double cell, Load load, size_t bytes = size_t{64} << 20);

  double cell() const { return cell_; }
  /// Height at map coordinates, m; NaN in voids.
  double at(double x, double y);
  /// Whether the surface lies within `tolerance` of `height` on the whole segment from a to b (map coordinates): exact, as the surface is
  /// linear between the places where the segment crosses an edge.
  bool within(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double height, double tolerance);
  /// The same at every node inside the triangle a, b, c: with within() on its three sides it holds for the whole triangle.
  bool within_inside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, double height, double tolerance);

 private:
  struct Page {
    std::vector<float> height;
    std::uint64_t used = 0;
  };
  const Page& page(std::int64_t pi, std::int64_t pj);
  float node(std::int64_t i, std::int64_t j);
  /// Of a square, counter-clockwise from the south-west.
  std::array<float, 4> corners(std::int64_t i, std::int64_t j);
  /// On the square with south-west node (i, j), s and t from 0 to 1 across it.
  double in_square(std::int64_t i, std::int64_t j, double s, double t);
  /// On an edge between a known and a void square: from the known one.
  double at_node_units(double u, double v);
  Eigen::Vector2d node_units(const Eigen::Vector2d& p) const { return p / cell_ - Eigen::Vector2d(0.5, 0.5); }

  double cell_;
  Load load_;
  size_t most_pages_;
  std::unordered_map<std::uint64_t, Page> pages_;
  std::uint64_t clock_ = 0, last_key_ = 0;
  const Page* last_ = nullptr;
};

}  // namespace swath::terrain
