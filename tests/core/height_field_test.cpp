// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/height_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"

namespace swath::core {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

TEST(HeightField, APlaneIsItself) {
  std::vector<float> z;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 5; ++i) z.push_back(static_cast<float>(100 + 2 * i - 3 * j));
  const HeightField f({1000, 2000, 10, 20, 5, 4}, z);  // nodes 10 m apart eastward, 20 m northward
  const HeightField::Sample s = f.at(1013, 2031);
  EXPECT_NEAR(s.height, 100 + 0.2 * 13 - 0.15 * 31, 1e-9);
  EXPECT_NEAR(s.gradient.x(), 0.2, 1e-9);
  EXPECT_NEAR(s.gradient.y(), -0.15, 1e-9);
  EXPECT_NEAR(f.steepest(), std::hypot(0.2, 0.15), 1e-9);
  EXPECT_EQ(f.highest(), 108);
  EXPECT_EQ(f.lowest(), 91);
}

TEST(HeightField, BeyondTheNodesIsAsAtTheNearest) {
  const HeightField f({0, 0, 1, 1, 2, 1}, {5, 7});
  EXPECT_EQ(f.height(-10, 3), 5);
  EXPECT_EQ(f.height(99, 0), 7);
  EXPECT_EQ(f.at(99, 0).gradient.norm(), 0.0);
  EXPECT_TRUE(f.knows(1.4, 0.4));
  EXPECT_FALSE(f.knows(1.6, 0.0));
}

TEST(HeightField, UnknownNodesTakeTheNearest) {
  const HeightField f({0, 0, 1, 1, 4, 1}, {1, unknown, unknown, 9});
  EXPECT_EQ(f.height(1, 0), 1);
  EXPECT_EQ(f.height(2, 0), 9);
  EXPECT_FALSE(f.knows(1, 0));
  EXPECT_TRUE(f.knows(0, 0));
  EXPECT_THROW(HeightField({0, 0, 1, 1, 1, 1}, {unknown}), Error);
}

TEST(HeightField, LevelGroundIsEverywhere) {
  const HeightField f(612.25);
  EXPECT_EQ(f.height(-1e7, 1e7), 612.25);
  EXPECT_TRUE(f.knows(0, 0));
  EXPECT_EQ(f.steepest(), 0.0);
}

/// Central differences, away from the nodes' lines.
TEST(HeightField, TheGradientIsThatOfTheHeight) {
  std::vector<float> z;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 6; ++i) z.push_back(static_cast<float>(10 * std::sin(i * 1.3) * std::cos(j * 0.7)));
  const HeightField f({0, 0, 2, 3, 6, 6}, z);
  constexpr double d = 1e-4;
  for (const auto& [x, y] : {std::pair(0.5, 0.4), std::pair(3.3, 7.7), std::pair(9.1, 14.2)}) {
    const Eigen::Vector2d numeric((f.height(x + d, y) - f.height(x - d, y)) / (2 * d), (f.height(x, y + d) - f.height(x, y - d)) / (2 * d));
    EXPECT_LT((f.at(x, y).gradient - numeric).norm(), 1e-7);
    EXPECT_LE(f.at(x, y).gradient.norm(), f.steepest());
  }
}

}  // namespace
}  // namespace swath::core
