// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::core {

/// Heights of the ground that flights are planned and simulated over: known at the nodes of a lattice that follows the axes of the map,
/// bilinear between them, beyond the outermost nodes as at the nearest. A node without a height takes that of the nearest one that has one.
class HeightField {
 public:
  struct Sample {
    double height = 0.0;
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< d height / d (east, north)
  };
  /// Nodes: centres of the pixels of a raster.
  struct Nodes {
    double west = 0.0, south = 0.0;  ///< of the south-west node, m on the map
    double step_x = 1.0, step_y = 1.0;
    int nx = 1, ny = 1;
  };

  /// Level ground.
  explicit HeightField(double level = 0.0);
  /// Heights in m, row-major from the south-west; NaN where unknown. Throws core::Error where none is known.
  HeightField(const Nodes& nodes, std::vector<float> heights);

  Sample at(double x, double y) const;
  double height(double x, double y) const { return at(x, y).height; }
  /// Is the nearest node's height known, and does (x, y) lie within half a step of the nodes?
  bool knows(double x, double y) const;

  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  double steepest() const { return steepest_; }  ///< no gradient is longer

 private:
  void fill_unknown();
  Nodes nodes_;
  bool everywhere_ = false;  ///< level ground
  std::vector<float> heights_;
  std::vector<bool> known_;
  double lowest_ = 0.0, highest_ = 0.0, steepest_ = 0.0;
};

}  // namespace swath::core
