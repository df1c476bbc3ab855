// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/water.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

using Eigen::Vector3d;
constexpr double level = 12.0, bank_slope = 0.3;  // m; rise per metre from the water

core::Breakline box(core::BreaklineKind kind, double x0, double y0, double x1, double y1) {
  return {kind, "f: feature 1", {{{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}}}, false, 0.05};
}

double outside(double x, double y) {  // distance from the lake of 20 .. 60
  return std::hypot(std::max({20.0 - x, 0.0, x - 60.0}), std::max({20.0 - y, 0.0, y - 60.0}));
}

TEST(Water, LakeWithoutHeightsTakesALowQuantileOfItsShore) {
  const core::Block b = test::random_points(
      20000, 80.0,
      [](double x, double y) {
        const double d = outside(x, y);
        return d > 0 ? level + bank_slope * d : level - 3.0;  // what is inside has no say
      },
      4);
  const std::vector<core::Breakline> features{box(core::BreaklineKind::lake, 20, 20, 60, 60)};
  const WaterOptions o;
  const auto shores = shore_points(b, test::all_rows(b), b.size(), features, o);
  EXPECT_GT(shores.size(), 500u);
  for (const ShorePoint& p : shores) EXPECT_GE(p.z, level);
  core::Tally tally;
  const core::Breakline lake = with_heights(features[0], shores, o, tally);
  ASSERT_TRUE(lake.has_height);
  for (const Vector3d& v : lake.parts[0]) EXPECT_EQ(v.z(), lake.parts[0][0].z());
  EXPECT_NEAR(lake.parts[0][0].z(), level + 0.1 * o.shore.value * bank_slope, 0.03);  // a tenth of the strip's rise
  EXPECT_GT(lake.sigma, 0.005);
  EXPECT_LT(lake.sigma, 0.15);

  auto reversed = shores;
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(with_heights(features[0], reversed, o, tally).parts[0][0].z(), lake.parts[0][0].z());
  EXPECT_TRUE(tally.empty());
}

TEST(Water, OnlyOwnPointsTell) {
  const core::Block b = test::random_points(
      5000, 80.0, [](double, double) { return level; }, 4);
  const std::vector<core::Breakline> features{box(core::BreaklineKind::lake, 20, 20, 60, 60)};
  EXPECT_TRUE(shore_points(b, test::all_rows(b), 0, features, {}).empty());
}

TEST(Water, LakeWithHeightsKeepsThem) {
  core::Breakline lake = box(core::BreaklineKind::lake, 0, 0, 10, 10);
  lake.has_height = true;
  for (Vector3d& v : lake.parts[0]) v.z() = 5.0;
  core::Tally tally;
  EXPECT_EQ(with_heights(lake, {}, {}, tally).parts[0][2].z(), 5.0);
  EXPECT_TRUE(tally.empty());
  lake.parts[0][1].z() = 9.0;
  EXPECT_EQ(with_heights(lake, {}, {}, tally).parts[0][1].z(), 5.0);
  EXPECT_FALSE(tally.empty());
}

TEST(Water, WithoutAnyHeightItSaysSo) {
  core::Tally tally;
  EXPECT_FALSE(with_heights(box(core::BreaklineKind::lake, 0, 0, 10, 10), {}, {}, tally).has_height);
  EXPECT_FALSE(tally.empty());
}

TEST(Water, RiverFromShoresFalls) {
  // A straight river along x whose water falls by 1 in 100, with a bump of noise on its banks.
  const core::Block b = test::random_points(
      40000, 200.0,
      [](double x, double y) {
        return 50.0 - 0.01 * x + bank_slope * std::max(0.0, std::abs(y - 100.0) - 6.0) + (x > 90 && x < 96 ? 0.3 : 0.0);
      },
      5);
  const std::vector<core::Breakline> features{box(core::BreaklineKind::river, 10, 94, 190, 106)};
  core::Tally tally;
  const core::Breakline river = with_heights(features[0], shore_points(b, test::all_rows(b), b.size(), features, {}), {}, tally);
  ASSERT_TRUE(river.has_height);
  for (const Vector3d& v : river.parts[0])
    if (v.x() > 40 && v.x() < 160) {
      EXPECT_NEAR(v.z(), 50.0 - 0.01 * v.x(), 0.25) << v.x();
    }
  std::vector<Vector3d> south;
  for (const Vector3d& v : river.parts[0])
    if (v.y() == 94.0) south.push_back(v);
  std::sort(south.begin(), south.end(), [](const Vector3d& p, const Vector3d& q) { return p.x() < q.x(); });
  ASSERT_GT(south.size(), 150u);
  for (size_t k = 1; k < south.size(); ++k) EXPECT_LE(south[k].z(), south[k - 1].z() + 1e-12);
}

}  // namespace
}  // namespace swath::terrain
