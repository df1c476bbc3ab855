// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/level_plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace swath::filters {
namespace {

std::vector<Eigen::Vector3d> plane(double slope, double length, double width, double sigma) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<Eigen::Vector3d> out;
  for (int k = 0; k < 400; ++k) {
    const double x = length * place(random), y = width * place(random);
    out.emplace_back(x, y, 50.0 + slope * x + noise(random));
  }
  return out;
}

TEST(LevelPlane, ALevelPlaneComesOutAndASlopeDoesNot) {
  auto water = plane(0.0005, 100.0, 30.0, 0.03);
  const auto found = level_plane(water, 0.003, 0.003);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->at(40.0, 0.0), 50.02, 0.01);
  EXPECT_NEAR(found->sigma, 0.03, 0.004);  // 400 points: 3.5 %
  auto road = plane(0.005, 100.0, 30.0, 0.03);
  EXPECT_FALSE(level_plane(road, 0.003, 0.003));
}

TEST(LevelPlane, TooShortToTell) {
  auto few = plane(0.002, 2.0, 2.0, 0.03);
  EXPECT_FALSE(level_plane(few, 0.003, 0.001));  // 0.03 m / 11 m
  const auto level = level_plane(few, 0.003, 1.0);
  ASSERT_TRUE(level);  // the slope lies within what the points can tell
  EXPECT_LT(std::abs(level->east), 0.002) << "the prior makes it level";
}

TEST(LevelPlane, DoesNotDependOnTheOrder) {
  auto one = plane(0.001, 60.0, 60.0, 0.03), other = one;
  std::shuffle(other.begin(), other.end(), std::mt19937(5));
  EXPECT_EQ(level_plane(one, 0.003, 0.003)->east, level_plane(other, 0.003, 0.003)->east);
}

}  // namespace
}  // namespace swath::filters
