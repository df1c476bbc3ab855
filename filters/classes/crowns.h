// SPDX-License-Identifier: GPL-3.0-or-later
// Trees that touch or overhang a building: returns at its roof that belong to a crown.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/bins.h"

namespace swath::filters {

/// Evidence that a return gives about the place around it.
enum class Witness : std::uint8_t {
  none,
  roof,   ///< on a plane of a roof
  crown,  ///< off the ground, on no plane and no roof, and its pulse went on
};

/// Metres of points around a place that Crowns::holds depends on there.
double crowns_halo();

class Crowns {
 public:
  Crowns(const core::Block& b, const std::vector<Witness>& witness);

  /// Is return p a crown's? Each return of a crown counts as two of a roof, and the crowns must outweigh the roofs both within 2 m and
  /// among the returns within 1.5 m in plan that lie above it or up to 1 m below: a wall has its roof above it. Does not depend on the
  /// order of the points.
  bool holds(size_t p) const;

 private:
  const core::Block& block_;
  const std::vector<Witness>& witness_;
  Bins witnesses_;
  std::vector<std::uint8_t> near_;  ///< per cell of the bins: has it or a neighbour that is looked at a crown's return?
};

}  // namespace swath::filters
