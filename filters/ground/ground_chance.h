// SPDX-License-Identifier: GPL-3.0-or-later
// The chance that a return is from the bare ground, from the heights of all returns around it over the ground's surface.
#pragma once

#include <vector>

#include "core/block.h"

namespace swath::filters {

/// What is known of one return beside its surface.
struct ReturnOverGround {
  float above;   ///< m over the surface; NaN: not judged
  float spread;  ///< m, standard deviation of the ground's returns about the surface there
  float doubt;   ///< m, what the surface may be off by where it does, at least twice `spread`
  bool deep;     ///< below all that can be ground
};

/// 0 to 1 for each of the first `own` points; `returns` has one entry per point of the block. The result depends on the returns within
/// ground_chance_reach metres and not on their order.
std::vector<float> ground_chances(const core::Block& b, size_t own, const std::vector<ReturnOverGround>& returns);

extern const double ground_chance_reach;  ///< m

}  // namespace swath::filters
