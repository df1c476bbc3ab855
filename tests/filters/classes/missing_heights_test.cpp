// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/missing_heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

TEST(MissingHeights, AreThoseAboveTheNearestKnownGround) {
  core::Block b;
  core::resize(b, 5);
  b.x = {2.0, 10.0, 14.0, 26.0, 100.0};
  b.y = {2.0, 2.0, 2.0, 2.0, 2.0};
  b.z = {50.0, 58.0, 47.0, 60.0, 60.0};
  b.height = {1.0f, 10.0f, unknown, unknown, unknown};
  const std::vector<std::uint32_t> rows = fill_missing_heights(b);
  EXPECT_EQ(rows, (std::vector<std::uint32_t>{2, 3, 4}));
  EXPECT_EQ(b.height[0], 1.0f);
  EXPECT_EQ(b.height[2], -1.0f);
  EXPECT_EQ(b.height[3], 12.0f);
  EXPECT_TRUE(std::isnan(b.height[4]));  // too far
  b.height[0] = b.height[1] = unknown;
  b.height[2] = b.height[3] = unknown;
  fill_missing_heights(b);
  for (const float h : b.height) EXPECT_TRUE(std::isnan(h));
}

}  // namespace
}  // namespace swath::filters
