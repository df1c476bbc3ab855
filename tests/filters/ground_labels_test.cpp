// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground_labels.h"

#include <gtest/gtest.h>

namespace swath::filters {
namespace {

TEST(GroundLabels, OnlyOwnUsableLastReturnsAreSet) {
  core::Block b;
  core::resize(b, 6);
  core::add_columns(b, {core::Column::classification, core::Column::flags, core::Column::return_number, core::Column::return_count});
  b.return_number = {1, 1, 2, 1, 1, 1};
  b.return_count = {1, 2, 2, 1, 1, 1};
  b.flags[3] = core::flag::withheld;
  const GroundCounts n =
      set_ground_classes(b, 5, {Verdict::ground, Verdict::ground, Verdict::object, Verdict::ground, Verdict::no_surface, Verdict::ground});
  EXPECT_EQ(b.classification, (std::vector<std::uint8_t>{2, 1, 1, 0, 1, 0}));
  EXPECT_EQ(n.ground, 1u);
  EXPECT_EQ(n.object, 3u);
  EXPECT_EQ(n.early, 1u);
  EXPECT_EQ(n.untouched, 1u);
  EXPECT_EQ(n.no_surface, 1u);
}

TEST(GroundLabels, PointsOfUnknownReturnMayBeGround) {
  core::Block b;
  core::resize(b, 1);
  EXPECT_TRUE(may_be_ground(b, 0));
  EXPECT_EQ(set_ground_classes(b, 1, {Verdict::ground}).ground, 1u);
  EXPECT_EQ(b.classification, std::vector<std::uint8_t>{2});
}

}  // namespace
}  // namespace swath::filters
