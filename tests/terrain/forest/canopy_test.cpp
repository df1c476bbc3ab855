// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/forest/canopy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::terrain {
namespace {

void add(core::Block& b, double x, double height, int number, std::uint8_t cls) {
  b.x.push_back(x), b.y.push_back(1.0), b.z.push_back(100.0 + height), b.height.push_back(static_cast<float>(height));
  b.return_number.push_back(static_cast<std::uint8_t>(number)), b.classification.push_back(cls), b.flags.push_back(0);
}

TEST(Canopy, CoverIsOfFirstReturnsAndPercentilesAreOfHighOnes) {
  core::Block b;
  for (int k = 0; k <= 20; ++k) add(b, 3.0, k, 1, k < 2 ? 2 : 5);  // heights 2 to 20 above the limit
  for (int k = 0; k < 9; ++k) add(b, 3.0, 0.0, 2, 2);              // last returns do not count for the cover
  add(b, 3.0, 30.0, 1, core::point_class::building);
  add(b, 13.0, 0.5, 1, 2);
  const CanopyCells c = canopy_cells(b, {10.0, 0, 0, 3, 1}, 2.0);
  EXPECT_FLOAT_EQ(c.cover[0], 19.0f / 21.0f);
  EXPECT_FLOAT_EQ(c.height[0][0], 6.5f);
  EXPECT_FLOAT_EQ(c.height[1][0], 11.0f);
  EXPECT_FLOAT_EQ(c.height[4][0], 20.0f);
  EXPECT_FLOAT_EQ(c.first_returns[0], 21.0f);
  EXPECT_FLOAT_EQ(c.cover[1], 0.0f);
  EXPECT_TRUE(std::isnan(c.height[1][1]));
  EXPECT_TRUE(std::isnan(c.cover[2]));
  EXPECT_TRUE(std::isnan(c.first_returns[2]));
}

}  // namespace
}  // namespace swath::terrain
