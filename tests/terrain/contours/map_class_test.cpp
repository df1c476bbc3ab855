// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_class.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::terrain {
namespace {

TEST(MapClass, TheDecreesShares) {
  // PEC (9 of 10 heights) is 1.6449 standard errors: 1/2, 3/5, 3/4 of the interval to the decree's rounding.
  constexpr double nine_of_ten = 1.6449;
  EXPECT_NEAR(map_classes[0].standard_error * nine_of_ten, 0.5, 0.05);
  EXPECT_NEAR(map_classes[1].standard_error * nine_of_ten, 0.6, 0.06);
  EXPECT_NEAR(map_classes[2].standard_error * nine_of_ten, 0.75, 0.075);
}

TEST(MapClass, BestClassKept) {
  EXPECT_EQ(map_class_of(1.0, 0.10), 'A');
  EXPECT_EQ(map_class_of(0.3, 0.10), 'A');
  EXPECT_EQ(map_class_of(0.29, 0.10), 'B');
  EXPECT_EQ(map_class_of(0.25, 0.10), 'B');
  EXPECT_EQ(map_class_of(0.24, 0.10), 'C');
  EXPECT_EQ(map_class_of(0.2, 0.10), 'C');
  EXPECT_EQ(map_class_of(0.19, 0.10), '-');
}

TEST(MapClass, SmallestAndUsualIntervals) {
  EXPECT_NEAR(smallest_interval(map_classes[0], 0.15), 0.45, 1e-12);
  EXPECT_DOUBLE_EQ(usual_interval(0.45), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(0.3), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(0.25), 0.25);
  EXPECT_DOUBLE_EQ(usual_interval(0.5), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(6.0), 10.0);
  EXPECT_DOUBLE_EQ(usual_interval(1.0), 1.0);
}

TEST(MapClass, AModelsSigmaJudgesTheInterval) {
  core::Grid grid(core::Lattice{1.0, 0, 0, 4, 3});
  grid.height.assign(12, 100.0f);
  grid.sigma.assign(12, 0.3f);
  grid.sigma[5] = 0.9f;                                         // cell (1, 1)
  grid.height[11] = std::numeric_limits<float>::quiet_NaN();    // cell (3, 2)
  SurfaceFacts facts = facts_of(grid, {1.0, 1, 1, 3, 2}, 1.0);  // one of them beyond, one void
  EXPECT_EQ(facts.heights, 5u);
  EXPECT_EQ(facts.beyond, 1u);
  facts += facts_of(grid, {1.0, 0, 0, 4, 1}, 1.0);
  EXPECT_EQ(facts.sigmas, 9u);
  const double sigma = std::sqrt((8 * 0.09 + 0.81) / 9);
  const CarriedInterval carried = judge_interval(facts, 1.0, 1100.0, 1.0);
  EXPECT_NEAR(*carried.c_factor, 1000.0, 1e-9);
  EXPECT_NEAR(*carried.model_sigma, sigma, 1e-6);
  EXPECT_EQ(*carried.map_class, "C");
  EXPECT_NEAR(carried.smallest->of[0], 3 * sigma, 1e-6);
  EXPECT_NEAR(*carried.beyond_class_c, 1.0 / 9.0, 1e-12);
  EXPECT_TRUE(carried.findings.empty());
  const CarriedInterval finer = judge_interval(facts, 0.5, std::nan(""), 1.0);
  EXPECT_FALSE(finer.c_factor);
  EXPECT_EQ(*finer.map_class, "none");
  ASSERT_EQ(finer.findings.size(), 1u);
  EXPECT_NE(finer.findings[0].find("contours every 0.5 m say more"), std::string::npos) << finer.findings[0];
}

TEST(MapClass, TooManyLevelsAreNamedWithTheirHeights) {
  core::Grid grid(core::Lattice{1.0, 0, 0, 2, 1});
  grid.height = {512.3f, 561.2f};
  SurfaceFacts low = facts_of(grid, {1.0, 0, 0, 1, 1}, 1.0);
  const SurfaceFacts high = facts_of(grid, {1.0, 1, 0, 1, 1}, 1.0);
  EXPECT_EQ(too_many_levels(low, 1e-6, 1.0), "");  // one height alone
  low += high;
  EXPECT_EQ(too_many_levels(low, 0.0025, 1.0), "");  // 19 560
  const std::string said = too_many_levels(low, 0.001, 1.0);
  EXPECT_NE(said.find("contours every 0.001 m between heights of 512.3 and 561.2 m are 489"), std::string::npos) << said;
  EXPECT_NEAR(least_interval(low, 1.0), 0.0025, 1e-9);
  EXPECT_EQ(too_many_levels(low, least_interval(low, 1.0), 1.0), "");
  const std::string feet = too_many_levels(low, 0.0003048, 0.3048);
  EXPECT_NE(feet.find("every 0.001 ft between heights of 1680.8 and 1841.2 ft"), std::string::npos) << feet;
  EXPECT_EQ(too_many_levels({}, 0.001, 1.0), "");  // no height at all
  EXPECT_EQ(written_out(5e-4), "0.0005");
  EXPECT_EQ(written_out(1e-6), "0.000001");
  EXPECT_EQ(written_out(2.5), "2.5");
}

}  // namespace
}  // namespace swath::terrain
