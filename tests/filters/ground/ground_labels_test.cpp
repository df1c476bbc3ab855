// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_labels.h"

#include <gtest/gtest.h>

#include <array>

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

TEST(GroundLabels, ManyPointsAtOnceAreJudgedAsEach) {
  core::Block b;
  for (int p = 0; p < 24; ++p) {
    b.x.push_back(p), b.y.push_back(0), b.z.push_back(0);
    b.return_count.push_back(2), b.return_number.push_back(static_cast<std::uint8_t>(1 + p % 2));
    b.flags.push_back(p % 3 == 0 ? core::flag::withheld : 0);
    b.classification.push_back(p % 5 == 0   ? core::point_class::low_noise
                               : p % 7 == 0 ? core::point_class::high_noise
                                            : core::point_class::unassigned);
  }
  std::array<std::uint8_t, 20> may{};
  may_be_ground(b, 4, may.size(), may.data());
  for (size_t k = 0; k < may.size(); ++k) EXPECT_EQ(may[k] != 0, may_be_ground(b, k + 4)) << k;
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
