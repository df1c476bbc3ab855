// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/block_solid.h"

#include <gtest/gtest.h>

namespace swath::terrain {
namespace {

const Outline courtyard{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}, {{{5, 5}, {5, 15}, {15, 15}, {15, 5}}}};

TEST(BlockSolid, IsClosedAndLooksOutwards) {
  const Solid block = block_over(courtyard, 3.0, 10.0);
  ASSERT_EQ(block.size(), 10u);  // ground, eight walls, roof
  EXPECT_TRUE(is_closed(block));
  EXPECT_NEAR(volume(block), 300.0 * 7.0, 1e-9);
  EXPECT_EQ(block.front().kind, Boundary::ground);
  EXPECT_EQ(block.back().kind, Boundary::roof);
  EXPECT_EQ(block.back().rings.size(), 2u);
}

TEST(BlockSolid, AMissingOrTurnedFaceIsSeen) {
  Solid open = block_over(courtyard, 3.0, 10.0), turned = open;
  open.erase(open.begin() + 3);
  EXPECT_FALSE(is_closed(open));
  std::reverse(turned[3].rings[0].begin(), turned[3].rings[0].end());
  EXPECT_FALSE(is_closed(turned));
  Solid inside_out = block_over(courtyard, 3.0, 10.0);
  for (SolidFace& face : inside_out)
    for (auto& ring : face.rings) std::reverse(ring.begin(), ring.end());
  EXPECT_TRUE(is_closed(inside_out));
  EXPECT_LT(volume(inside_out), 0.0);
}

TEST(BlockSolid, WithoutHeightThereIsNone) {
  EXPECT_TRUE(block_over(courtyard, 10.0, 10.0).empty());
  EXPECT_TRUE(block_over(courtyard, std::numeric_limits<double>::quiet_NaN(), 10.0).empty());
  EXPECT_TRUE(block_over({}, 0.0, 10.0).empty());
  EXPECT_FALSE(is_closed({}));
}

}  // namespace
}  // namespace swath::terrain
