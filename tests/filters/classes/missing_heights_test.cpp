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
  const OwnBox everywhere(b, b.size(), 0.0);
  EXPECT_EQ(fill_missing_heights(b, everywhere).all, (std::vector<std::uint32_t>{2, 3, 4}));
  EXPECT_EQ(b.height[0], 1.0f);
  EXPECT_EQ(b.height[2], -1.0f);
  EXPECT_EQ(b.height[3], 12.0f);
  EXPECT_TRUE(std::isnan(b.height[4]));  // too far
  b.height[0] = b.height[1] = unknown;
  b.height[2] = b.height[3] = unknown;
  fill_missing_heights(b, everywhere);
  for (const float h : b.height) EXPECT_TRUE(std::isnan(h));
}

/// A line of points 4 m apart, without heights beyond `from` up to `to`; the ground rises by 1 %.
core::Block row_of(double from, double to, double above) {
  core::Block b;
  for (double x = 2.0; x < 300.0; x += 4.0) {
    const bool in_void = x >= from && x <= to;
    b.x.push_back(x), b.y.push_back(2.0), b.z.push_back(0.01 * x + (in_void ? above : 0.0));
    b.height.push_back(in_void ? unknown : 0.0f);
  }
  core::resize(b, b.x.size());
  return b;
}

TEST(MissingHeights, AreCarriedAcrossAVoidWhoseRimIsKnown) {
  core::Block hall = row_of(60.0, 180.0, 12.0), wide = row_of(40.0, 260.0, 12.0), water = row_of(60.0, 180.0, -0.5);
  const OwnBox everywhere(hall, hall.size(), 0.0);
  EXPECT_EQ(fill_missing_heights(hall, everywhere).across.size(), 18u);
  for (size_t p = 0; p < hall.size(); ++p)
    if (hall.x[p] >= 90.0 && hall.x[p] <= 150.0) {
      EXPECT_NEAR(hall.height[p], 12.0f, 0.05f) << hall.x[p];
    }
  EXPECT_EQ(fill_missing_heights(wide, everywhere).across.size(), 0u);  // 110 m from both sides, or more from one
  EXPECT_EQ(fill_missing_heights(water, everywhere).across.size(), 0u);
  EXPECT_TRUE(std::isnan(water.height[29]));
  core::Block elsewhere = row_of(60.0, 180.0, 12.0);
  EXPECT_EQ(fill_missing_heights(elsewhere, OwnBox(elsewhere, 1, 10.0)).across.size(), 0u);
}

}  // namespace
}  // namespace swath::filters
