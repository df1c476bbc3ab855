// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/regions.h"

#include <gtest/gtest.h>

namespace swath::terrain {
namespace {

TEST(Regions, CellsBecomeRunsWhateverTheirOrder) {
  const std::vector<CellRun> runs = runs_of({{3, 1}, {-2, 0}, {2, 1}, {3, 1}, {5, 1}, {-1, 0}});
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].first, -2);
  EXPECT_EQ(runs[0].last, -1);
  EXPECT_EQ(runs[1].first, 2);
  EXPECT_EQ(runs[1].last, 3);
  EXPECT_EQ(runs[2].first, 5);
}

TEST(Regions, CellsThatTouchAtACornerAreOneGroup) {
  // A fork that only its third row joins, and a cell apart.
  const CellSet set({{0, 0, 1}, {0, 6, 7}, {1, 2, 2}, {1, 5, 5}, {2, 3, 4}, {2, 20, 20}});
  EXPECT_EQ(set.groups(), 2u);
  EXPECT_EQ(set.group(0, 0), 0u);
  EXPECT_EQ(set.group(7, 0), 0u);
  EXPECT_EQ(set.group(3, 2), 0u);
  EXPECT_EQ(set.group(20, 2), 1u);
  EXPECT_TRUE(set.holds(1, 0));
  EXPECT_FALSE(set.holds(2, 0));
  EXPECT_FALSE(set.holds(0, 9));
}

TEST(Regions, PiecesOfOneRowThatTilesCutAreOne) {
  const CellSet set({{0, 0, 4}, {0, 5, 9}, {0, 3, 6}, {1, 11, 12}});
  EXPECT_EQ(set.groups(), 2u);
  EXPECT_EQ(set.group(0, 0), set.group(9, 0));
  EXPECT_EQ(CellSet({}).groups(), 0u);
}

}  // namespace
}  // namespace swath::terrain
