// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/ring.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace swath::core {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

TEST(Ring, AreaHasTheSignOfTheTurn) {
  Ring r{{600000, 5300000}, {600004, 5300000}, {600004, 5300003}, {600000, 5300003}};
  EXPECT_DOUBLE_EQ(signed_area(r), 12.0);
  r.push_back(r.front());
  EXPECT_DOUBLE_EQ(signed_area(r), 12.0);
  std::reverse(r.begin(), r.end());
  EXPECT_DOUBLE_EQ(signed_area(r), -12.0);
  EXPECT_EQ(signed_area({}), 0.0);
}

TEST(Ring, EveryPlaceBelongsToOneOfTwoRingsThatShareASide) {
  const Ring whole{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, left{{0, 0}, {3, 0}, {7, 10}, {0, 10}}, right{{3, 0}, {10, 0}, {10, 10}, {7, 10}};
  const auto holds = [](const Ring& r, double x, double y) {
    bool odd = false;
    for (size_t k = 0; k < r.size(); ++k) odd = odd != crosses_eastward(r[k], r[(k + 1) % r.size()], x, y);
    return odd;
  };
  for (int j = 0; j <= 40; ++j)
    for (int i = 0; i <= 40; ++i) {
      const double x = 0.25 * i, y = 0.25 * j;
      EXPECT_EQ(holds(left, x, y) != holds(right, x, y), holds(whole, x, y)) << x << " " << y;
    }
  EXPECT_TRUE(holds(left, 2.0, 5.0));
  EXPECT_TRUE(holds(whole, 0.0, 0.0));  // the south-west corner belongs to it, the north-east one does not
  EXPECT_FALSE(holds(whole, 10.0, 10.0));
}

}  // namespace
}  // namespace swath::core
