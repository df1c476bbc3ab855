// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/area.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::terrain {
namespace {

using Eigen::Vector3d;

TEST(Area, OutlineAndIsland) {
  const Area a({{Vector3d(0, 0, 0), Vector3d(10, 0, 0), Vector3d(10, 10, 0), Vector3d(0, 10, 0)},
                {Vector3d(4, 4, 0), Vector3d(6, 4, 0), Vector3d(6, 6, 0), Vector3d(4, 6, 0)}});
  EXPECT_TRUE(a.holds(1, 1));
  EXPECT_FALSE(a.holds(5, 5));
  EXPECT_FALSE(a.holds(11, 5));
  EXPECT_FALSE(a.holds(-1, 5));
  EXPECT_TRUE(a.box_meets(9, 9, 20, 20));
  EXPECT_FALSE(a.box_meets(11, 0, 20, 20));
  EXPECT_FALSE(Area().holds(0, 0));
}

TEST(Area, ManySidesAgainstTheDistanceFromTheMiddle) {
  std::vector<Vector3d> star;
  const auto radius = [](double angle) { return 10.0 + 3.0 * std::sin(7.0 * angle); };
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2.0 * M_PI * k / 2000.0;
    star.emplace_back(radius(angle) * std::cos(angle), radius(angle) * std::sin(angle), 0.0);
  }
  const Area a({star});
  for (int j = -140; j <= 140; ++j)
    for (int i = -140; i <= 140; ++i) {
      const double x = 0.1 * i, y = 0.1 * j, r = std::hypot(x, y), edge = radius(std::atan2(y, x));
      if (std::abs(r - edge) < 0.01) continue;  // chords of the outline
      ASSERT_EQ(a.holds(x, y), r < edge) << x << ' ' << y;
    }
}

}  // namespace
}  // namespace swath::terrain
