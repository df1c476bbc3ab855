// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of the trajectory that are faster than its corrections, seen in what is left on the planes.
#pragma once

#include <vector>

#include "calib/adjust/adjustment.h"

namespace swath::calib {

/// Variance of the groups' standardised residuals that they have in common within short stretches of a line, over what independent
/// residuals would have: near 1, or below where the corrections follow single planes.
struct ShortWaves {
  double shift = 1.0;  ///< all to one side
  double turn = 1.0;   ///< left against right
  int stretches = 0;
  /// Whether one of the two is larger than chance makes it (4 sigmas of a mean of so many squares) and matters.
  bool seen() const;
};

/// `within`: length of a stretch, s > 0. Groups that were rejected or have no redundancy take no part.
ShortWaves short_waves(const std::vector<GroupResidual>& groups, double within);

}  // namespace swath::calib
