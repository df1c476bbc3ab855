// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

/// A return in the open, as a survey of 8 returns per square metre has them.
GroundEvidence on_ground() {
  GroundEvidence e;
  e.chance = 0.999F, e.spread = e.narrowed = 0.03F, e.slope = 0.05F, e.standing = 0.01F, e.support = 300.0F, e.splitting = 0.05F;
  return e;
}

GroundEvidence plant(float height) {
  GroundEvidence e = on_ground();
  e.chance = 0.01F, e.above = height, e.standing = 0.4F;
  e.nearest = {height, height, height, 0.0F, 0.9F};
  return e;
}

TEST(GroundProbability, IsHighOnTheSurfaceAndFallsWithHeight) {
  for (const Grass grass : {Grass::mown, Grass::bare_earth}) {
    EXPECT_GT(ground_probability(on_ground(), 0.03, grass), 0.95F);
    float last = 1.0F;
    for (const float height : {0.3F, 0.6F, 1.2F}) {
      const float p = ground_probability(plant(height), 0.03, grass);
      EXPECT_LT(p, 0.1F) << height;
      EXPECT_LE(p, last) << height;
      last = p;
    }
  }
}

TEST(GroundProbability, ASurfaceOverDeepReturnsIsNoReasonToTakeWhatStandsAboveIt) {
  for (const Grass grass : {Grass::mown, Grass::bare_earth})
    for (const float sunken : {0.1F, 0.2F, 0.3F})
      for (const float height : {0.3F, 0.6F, 1.2F}) {
        GroundEvidence e = plant(height);
        e.sunken = sunken, e.spread = e.narrowed = 0.05F;
        EXPECT_LT(ground_probability(e, 0.03, grass), 0.5F) << height << " m, " << sunken;
      }
}

TEST(GroundProbability, WhatStandsBesideItsLikeIsMoreProbable) {
  GroundEvidence kerb = plant(0.15F);
  kerb.standing = 0.1F;
  GroundEvidence alone = kerb;
  kerb.nearest = {0.14F, 0.01F, 0.0F, 0.9F, 0.1F};
  EXPECT_GT(ground_probability(kerb, 0.03, Grass::mown), ground_probability(alone, 0.03, Grass::mown) + 0.2F);
}

TEST(GroundProbability, NoEvidenceIsCertainAndFarFromTheSurfaceThereIsNoGround) {
  GroundEvidence e = on_ground();
  e.chance = 1.0F;
  const float best = ground_probability(e, 0.03, Grass::mown);
  EXPECT_LE(best, 0.9976F);
  e.above = 3.5F;
  EXPECT_EQ(ground_probability(e, 0.03, Grass::mown), 0.0F);
  e.above = -2.0F;
  EXPECT_EQ(ground_probability(e, 0.03, Grass::mown), 0.0F) << "a low outlier";
  e.above = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ground_probability(e, 0.03, Grass::mown), 0.0F) << "not judged";
}

TEST(GroundProbability, TheNearestReturnsAreThoseOfTheEightAround) {
  core::Block b;
  core::add_columns(b, {core::Column::return_count});
  std::vector<float> above;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      b.x.push_back(100.0 + 0.5 * i + 0.001 * j), b.y.push_back(200.0 + 0.5 * j), b.z.push_back(0.0);
      b.return_count.push_back(i < 4 ? 2 : 1);
      above.push_back(i < 4 ? 0.0F : 0.4F);
    }
  std::vector<GroundEvidence> e(above.size());
  for (size_t p = 0; p < e.size(); ++p) e[p].above = above[p];
  look_around(b, above, e);
  const NearestReturns& edge = e[4 * 9 + 4].nearest;  // three of its eight lie on the lower side
  EXPECT_FLOAT_EQ(edge.over_lowest, 0.4F);
  EXPECT_FLOAT_EQ(edge.over_second, 0.4F);
  EXPECT_FLOAT_EQ(edge.over_fourth, 0.0F);
  EXPECT_FLOAT_EQ(edge.level, 0.625F);
  EXPECT_FLOAT_EQ(edge.lower, 0.375F);
  EXPECT_NEAR(e[0].splitting, 4.0 / 9.0, 0.15);
}

}  // namespace
}  // namespace swath::filters
