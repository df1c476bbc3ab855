// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/deck_heights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

TEST(DeckHeights, GroundGivesTheLevelAndLowOutliersAreNotWhatIsBelow) {
  core::Block b;
  std::vector<std::uint8_t> kinds;
  const auto add = [&](double x, double z, std::uint8_t kind) { test::add_point(b, x + 0.5, 0.5, z), kinds.push_back(kind); };
  add(0, 5.0, cls::ground), add(0, 5.4, cls::ground), add(0, 9.0, cls::unassigned);  // a deck under a crown
  add(1, 4.0, cls::unassigned);                                                      // beside it
  add(2, 3.4, cls::unassigned);                                                      // deeper than all ground by 1.6 m
  add(3, 5.0, cls::ground), add(3, 3.0, cls::unassigned);                            // the same below ground
  add(4, 3.2, cls::unassigned), add(4, 9.0, cls::high_vegetation);                   // under a crown
  add(9, 3.0, cls::unassigned);                                                      // no ground is near
  b.classification = kinds;
  const core::Lattice l{1.0, 0, 0, 10, 1};
  const DeckHeights h = deck_heights(b, l);
  EXPECT_FLOAT_EQ(h.top[0], 5.4f);
  EXPECT_FLOAT_EQ(h.low[0], 5.0f);
  EXPECT_EQ(h.ground[0], 1);
  EXPECT_FLOAT_EQ(h.top[1], 4.0f);
  EXPECT_FLOAT_EQ(h.low[1], 4.0f);
  EXPECT_EQ(h.ground[1], 0);
  EXPECT_TRUE(std::isnan(h.low[2]));
  EXPECT_FLOAT_EQ(h.low[3], 5.0f);
  EXPECT_FLOAT_EQ(h.low[4], 9.0f);
  EXPECT_TRUE(std::isnan(h.top[5]) && std::isnan(h.low[5]));
  EXPECT_FLOAT_EQ(h.low[9], 3.0f);
}

}  // namespace
}  // namespace swath::filters
