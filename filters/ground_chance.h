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
  float doubt;   ///< m, what the surface may err by where it does, at least twice `spread`
  bool deep;     ///< below all that can be ground
};

/// What the returns around say of one.
struct GroundChance {
  float chance = 0.0F;       ///< 0 to 1, that it is ground
  float over_lowest = 0.0F;  ///< m over the lowest return within a cell of 1 m and the eight around it; outliers apart
  float low_objects = 0.0F;  ///< returns a little above the ground's per return of the ground, over some 6 m
};

/// One entry for each of the first `own` points, of zeros where a return is not judged; `returns` has one entry per point of the block. The
/// result depends on the returns within ground_chance_reach metres and not on their order.
std::vector<GroundChance> ground_chances(const core::Block& b, size_t own, const std::vector<ReturnOverGround>& returns);

extern const double ground_chance_reach;  ///< m

}  // namespace swath::filters
