// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/outlines.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::quality {
namespace {

double signed_area(const std::vector<Eigen::Vector2d>& ring) {
  double sum = 0.0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d a = ring[k], b = ring[(k + 1) % ring.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * sum;
}

TEST(Outlines, OfARectangleAreItsCorners) {
  const auto rings = outlines_of({{5, 2, 6}, {6, 2, 6}});
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].size(), 4u);
  EXPECT_EQ(signed_area(rings[0]), 8.0);
}

TEST(Outlines, AHoleRunsTheOtherWay) {
  const auto rings = outlines_of({{-1, 0, 5}, {0, 0, 2}, {0, 3, 5}, {1, 0, 5}});
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(signed_area(rings[0]), 15.0);
  EXPECT_EQ(signed_area(rings[1]), -1.0);
}

TEST(Outlines, CellsThatTouchAtACornerStayApart) {
  // A ring of cells whose hole touches the outside at a corner.
  const auto rings = outlines_of({{0, 0, 3}, {1, 0, 1}, {1, 2, 3}, {2, 0, 2}});
  double area = 0.0;
  for (const auto& ring : rings) area += signed_area(ring);
  EXPECT_EQ(area, 7.0);
  EXPECT_GT(signed_area(rings[0]), 7.0 - 1e-12);
}

TEST(Outlines, AStaircaseTurnsAtEveryStep) {
  const auto rings = outlines_of({{0, 0, 3}, {1, 1, 4}, {2, 2, 5}});
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(signed_area(rings[0]), 9.0);
  EXPECT_EQ(rings[0].size(), 12u);
}

}  // namespace
}  // namespace swath::quality
