// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/point_groups.h"

#include <gtest/gtest.h>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

using test::add_point;

std::vector<LonePoint> lone(const core::Block& b) { return lone_points(b, std::vector<std::uint8_t>(b.size(), 1), 10.0, 20); }

TEST(PointGroups, BirdsAreAboveAndMultipathIsBelow) {
  test::Scene s = test::make_scene("town");
  const size_t before = s.block.size();
  for (int k = 0; k < 12; ++k) add_point(s.block, 64.0 + 0.5 * k, 70.0 + 0.3 * k, s.terrain(64, 70) + 60.0 + 0.2 * k);
  for (int k = 0; k < 4; ++k) add_point(s.block, 120.0 + k, 90.0, s.terrain(120, 90) - 40.0);
  const std::vector<LonePoint> found = lone(s.block);
  ASSERT_EQ(found.size(), 16u);
  for (size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].row, before + k);
    EXPECT_EQ(found[k].above, k < 12);
  }
}

TEST(PointGroups, WhatIsLargeWideOrHangsTogetherStays) {
  test::Scene s = test::make_scene("flat");
  for (int k = 0; k < 21; ++k) add_point(s.block, 40.0 + 0.1 * k, 40.0, 160.0);   // more than 20: a roof seen from above
  for (int k = 0; k < 12; ++k) add_point(s.block, 100.0 + 5.0 * k, 60.0, 140.0);  // a wire
  for (int k = 0; k < 12; ++k) add_point(s.block, 60.0, 120.0, 105.0 + 5.0 * k);  // a mast
  EXPECT_TRUE(lone(s.block).empty());
}

TEST(PointGroups, CleanScenesHaveNone) {
  for (const std::string& name : test::scene_names()) EXPECT_TRUE(lone(test::make_scene(name).block).empty()) << name;
}

}  // namespace
}  // namespace swath::filters
