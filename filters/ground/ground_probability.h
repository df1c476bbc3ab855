// SPDX-License-Identifier: GPL-3.0-or-later
// The probability that a return is from the bare ground, from all that is known of it and of what lies around it.
#pragma once

#include <array>
#include <vector>

#include "core/block.h"

namespace swath::filters {

/// How a return lies among the eight nearest that may be ground. Heights are over the surface, so that slopes do not matter.
struct NearestReturns {
  float over_lowest = 0.0F, over_second = 0.0F, over_fourth = 0.0F;  ///< m over the lowest, the second and the fourth of them
  float level = 1.0F, lower = 0.0F;                                  ///< shares of them on its level, and below it
};

/// What is known of a return and of the ground around it.
struct GroundEvidence {
  float chance = 0.0F;     ///< that it is ground, as counted around it (ground_chance.h)
  float above = 0.0F;      ///< m over the surface; NaN: not judged
  float spread = 0.0F;     ///< m, standard deviation of the ground's returns about it
  float lowered = 0.0F;    ///< m that the ground lies below the surface, where that runs between two populations
  float narrowed = 0.0F;   ///< m, standard deviation of the ground's returns about the ground
  float slope = 0.0F;      ///< rise / run of the surface
  float standing = 0.0F;   ///< share of the returns around that stand knee-high
  float sunken = 0.0F;     ///< share of them that lie deep below the surface
  float support = 0.0F;    ///< ground's returns behind the surface
  float splitting = 0.0F;  ///< share of the pulses around with more than one return
  NearestReturns nearest;  ///< where the return is in doubt
};

constexpr size_t ground_terms = 46;
/// The terms whose weighted sum is the logarithm of the odds. `noise`: m, of heights on hard level ground.
std::array<double, ground_terms> terms_of(const GroundEvidence& e, double noise);

/// Which vegetation is ground: grass that is mown counts as ground, as makers of clouds commonly count it, or bare earth alone.
enum class Grass { mown, bare_earth };

/// 0.0025 to 0.9975, as no evidence is certain; 0 where not judged, beyond 3 m, or deeper than ground can lie.
float ground_probability(const GroundEvidence& e, double noise, Grass grass);

/// m below the surface that ground may lie.
double deepest_ground(double slope);
/// 0 to 1: how far the surface is in doubt of the ground between its returns. `support`: ground's returns behind the surface.
double sparseness(double support);
/// m that the surface may be off where returns are sparse.
double sparse_error(double slope, double standing, double sparse);

/// Fills in `nearest` of the first evidence.size() points of the block where they are in doubt, and `splitting` of all. `above`: m over the
/// surface of every point of the block, NaN where it may not be ground. Depends on the points within ground_probability_reach metres.
void look_around(const core::Block& b, const std::vector<float>& above, std::vector<GroundEvidence>& evidence);
extern const double ground_probability_reach;  ///< m

}  // namespace swath::filters
