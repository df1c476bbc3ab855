// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_chance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace swath::filters {
namespace {

struct Field {
  core::Block block;
  std::vector<ReturnOverGround> returns;
  std::vector<char> is_ground;
};

constexpr float spread = 0.03F;

/// 120 m x 120 m of level ground, `density` returns per m2 of which `stopped` come from plants between `low` and `high` m where x > 60.
Field field(double density, double stopped, double low, double high, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, spread);
  Field f;
  f.block.origin = {512000.0, 5402000.0, 0.0};
  const auto count = static_cast<size_t>(120.0 * 120.0 * density);
  core::resize(f.block, count);
  for (size_t p = 0; p < count; ++p) {
    f.block.x[p] = 120.0 * part(random);
    f.block.y[p] = 120.0 * part(random);
    const bool plant = f.block.x[p] > 60.0 && part(random) < stopped;
    const double z = noise(random) + (plant ? low + (high - low) * part(random) : 0.0);
    f.returns.push_back({static_cast<float>(z), spread, 2.0F * spread, false});
    f.is_ground.push_back(!plant);
  }
  return f;
}

TEST(GroundChance, IsTheShareOfGroundAmongReturnsOfThatChance) {
  std::array<double, 10> stated{}, true_ground{}, count{};
  double outside = 0.0;
  for (const auto& [stopped, low, high] : {std::array{0.3, 0.05, 0.3}, {0.5, 0.08, 0.2}, {0.7, 0.06, 0.4}, {0.5, 0.1, 1.0}}) {
    const Field f = field(4.0, stopped, low, high);
    const std::vector<float> chance = ground_chances(f.block, f.block.size(), f.returns);
    for (size_t p = 0; p < chance.size(); ++p) {
      const auto decile = static_cast<size_t>(std::min(9.0, 10.0 * chance[p]));
      stated[decile] += chance[p];
      true_ground[decile] += f.is_ground[p];
      ++count[decile];
      outside += chance[p] < 0 || chance[p] > 1;
    }
  }
  EXPECT_EQ(outside, 0.0);
  constexpr double bearable = 0.15;  // the density near the ground is that of the classes above it
  for (size_t k = 0; k < 10; ++k) {
    if (count[k] >= 200) {
      EXPECT_NEAR(stated[k] / count[k], true_ground[k] / count[k], bearable) << "decile " << k << " of " << count[k];
    }
  }
}

TEST(GroundChance, OneHeightIsDoubtfulInACropAndGroundOnBareSoil) {
  Field f = field(4.0, 0.6, 0.08, 0.3);
  const std::array<double, 2> x{30.0, 90.0};
  for (size_t k = 0; k < 2; ++k) {
    f.block.x[k] = x[k], f.block.y[k] = 60.0;
    f.returns[k].above = 3.0F * spread;
  }
  const std::vector<float> chance = ground_chances(f.block, 2, f.returns);
  EXPECT_GT(chance[0], 0.6F);
  EXPECT_LT(chance[1], 0.3F);
}

TEST(GroundChance, FallsWithHeightOverBareGroundAndStaysHighJustBelowIt) {
  Field f = field(4.0, 0.0, 0.0, 0.0);
  for (size_t k = 0; k < 4; ++k) f.block.x[k] = 30.0, f.block.y[k] = 60.0;
  const std::array<float, 4> above{0.0F, 0.2F, 2.0F, -0.06F};
  for (size_t k = 0; k < 4; ++k) f.returns[k].above = above[k];
  const std::vector<float> chance = ground_chances(f.block, 4, f.returns);
  EXPECT_GT(chance[0], 0.95F);
  EXPECT_GT(chance[0], chance[1]);
  EXPECT_LT(chance[2], 0.01F);
  EXPECT_GT(chance[3], 0.95F);
}

TEST(GroundChance, DependsNeitherOnTheOrderNorOnWhatLiesBeyondItsReach) {
  const Field f = field(2.0, 0.5, 0.08, 0.4);
  const std::vector<float> all = ground_chances(f.block, f.block.size(), f.returns);
  // Those within 10 m of the middle, with their surroundings, backwards.
  std::vector<std::uint32_t> rows, halo;
  for (size_t p = f.block.size(); p-- > 0;) {
    const double d = std::max(std::abs(f.block.x[p] - 60.0), std::abs(f.block.y[p] - 60.0));
    if (d < 10.0)
      rows.push_back(static_cast<std::uint32_t>(p));
    else if (d < 10.0 + ground_chance_reach)
      halo.push_back(static_cast<std::uint32_t>(p));
  }
  const size_t own = rows.size();
  rows.insert(rows.end(), halo.begin(), halo.end());
  std::vector<ReturnOverGround> some;
  for (const std::uint32_t p : rows) some.push_back(f.returns[p]);
  const std::vector<float> part = ground_chances(core::select(f.block, rows), own, some);
  for (size_t k = 0; k < own; ++k) ASSERT_EQ(part[k], all[rows[k]]);
}

TEST(GroundChance, WithoutGroundAroundThereIsNone) {
  Field f = field(1.0, 0.0, 0.0, 0.0);
  for (ReturnOverGround& r : f.returns) r.above = std::numeric_limits<float>::quiet_NaN();
  f.returns[0].above = 5.0F;
  const std::vector<float> chance = ground_chances(f.block, 2, f.returns);
  EXPECT_EQ(chance[0], 0.0F);
  EXPECT_EQ(chance[1], 0.0F);
  EXPECT_TRUE(ground_chances(f.block, 0, f.returns).empty());
}

}  // namespace
}  // namespace swath::filters
