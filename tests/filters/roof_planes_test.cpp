// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/roof_planes.h"

#include <gtest/gtest.h>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

/// Share of the scene's returns of one class that lie on planes.
double planar_share(const test::Scene& s, std::uint8_t kind) {
  std::vector<std::uint8_t> candidate(s.block.size());
  for (size_t p = 0; p < candidate.size(); ++p) candidate[p] = s.truth[p] != core::point_class::ground;
  const std::vector<std::uint8_t> planar = planar_points(s.block, candidate, 0.15);
  double all = 0, found = 0;
  for (size_t p = 0; p < candidate.size(); ++p) {
    EXPECT_TRUE(!planar[p] || candidate[p]);
    if (s.truth[p] == kind) ++all, found += planar[p];
  }
  EXPECT_GT(all, 0);
  return found / all;
}

TEST(RoofPlanes, RoofsAndDecksArePlanesAndCrownsAreNot) {
  constexpr double nearly_all = 0.97, nearly_none = 0.01;
  EXPECT_GE(planar_share(test::make_scene("town"), core::point_class::building), nearly_all);
  EXPECT_GE(planar_share(test::make_scene("bridge"), core::point_class::bridge_deck), nearly_all);
  EXPECT_LE(planar_share(test::make_scene("forest"), core::point_class::high_vegetation), nearly_none);
}

TEST(RoofPlanes, APlaneThatBeamsPassIsNoRoof) {
  test::Scene s = test::make_scene("town");
  s.block.return_count.assign(s.block.size(), 2);  // every beam goes on behind the roof
  EXPECT_EQ(planar_share(s, core::point_class::building), 0.0);
}

TEST(RoofPlanes, NoPointsNoPlanes) { EXPECT_TRUE(planar_points({}, {}, 0.1).empty()); }

}  // namespace
}  // namespace swath::filters
