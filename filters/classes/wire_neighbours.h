// SPDX-License-Identifier: GPL-3.0-or-later
// The returns around one that may belong to a wire, and the first tests of the lines through it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/bins.h"
#include "filters/classes/wire_directions.h"

namespace swath::filters {

namespace wire {
constexpr double shortest = 15.0;     // m of line
constexpr int fewest = 5;             // returns on the line
constexpr double steepest = 0.58;     // rise / run: a span of 150 m up a slope of 30 degrees
constexpr double near_line = 0.5;     // m from the line through two returns, each off the wire by up to half the beam's width
constexpr double on_line = 0.4;       // m from the line through all; holds a bundle of conductors together
constexpr double most_beside = 0.25;  // cells of the tube beside the line, of the returns on the line
constexpr int bins_of_reach = 4;
}  // namespace wire

/// The nearest returns around a point, seen from it; in any order.
class WireNeighbours {
 public:
  /// Those of `bins`, which are radius / wire::bins_of_reach wide, within `radius` m; of many only the nearest.
  void find(const Bins& bins, const core::Block& b, size_t p, double radius);

  size_t size() const { return n_; }
  Eigen::Vector3d operator[](size_t k) const { return {x_[k], y_[k], z_[k]}; }
  bool any_within(double distance) const;

  /// Can the straight line through the point and its k-th neighbour be a wire's?
  bool is_line(size_t k) const {
    const float run2 = x_[k] * x_[k] + y_[k] * y_[k];
    return run2 >= least_baseline * least_baseline && z_[k] * z_[k] <= wire::steepest * wire::steepest * run2;
  }
  /// Counts the neighbours by direction.
  void vote(WireDirections& directions);
  bool lies_in(const WireDirections& directions, size_t k) const { return directions.holds(bin_[k]); }
  /// Do enough neighbours lie near that line, over a stretch that is long enough, and few enough beside it?
  bool may_be_wire(size_t k) const;
  /// Do enough neighbours lie near that line?
  bool may_carry_on(size_t k) const;

 private:
  static constexpr size_t most = 96;             ///< neighbours looked at
  static constexpr double least_baseline = 7.0;  ///< m from the point to the one that gives the direction: half of the shortest line

  struct Neighbour {
    float distance2, x, y, z;
    std::uint32_t row;
  };
  void add_ring(const Bins& bins, const core::Block& b, size_t p, CellIndex c, int ring, float limit);
  bool is_bare(float east, float north, float rise, int n) const;

  std::vector<Neighbour> near_;
  std::array<float, most> x_, y_, z_;
  std::array<std::uint16_t, most> bin_;  ///< of directions, since the last vote
  size_t n_ = 0;
};

}  // namespace swath::filters
