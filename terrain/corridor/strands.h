// SPDX-License-Identifier: GPL-3.0-or-later
// Returns of wires by conductor: each strand holds those of one, or of one bundle, between two supports.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "terrain/corridor/strand.h"

namespace swath::terrain {

constexpr double support_beside = 8.0;  ///< m across a wire: arms of a support
constexpr double joint_growth = 1.5;    ///< of the scatter when two strands of one wire are fitted as one

struct StrandOptions {
  double tube = 0.4;       ///< m: returns so near to the growing curve belong to it; holds a bundle of conductors together
  double shortest = 15.0;  ///< m: strands below are left out
  int fewest = 8;          ///< returns of a strand
  double join = 80.0;      ///< m: longest stretch without returns within a strand
};

/// Strands of at least `shortest` with a curve that opens upwards. `supports`: places in plan of supports known by their own returns: no
/// strand runs on across one. The result does not depend on the order of the points.
std::vector<Strand> find_strands(const std::vector<WirePoint>& points, const std::vector<Eigen::Vector2d>& supports,
                                 const StrandOptions& o = {});

}  // namespace swath::terrain
