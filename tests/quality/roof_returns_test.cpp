// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/roof_returns.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/quality/roof_scene.h"

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(RoofReturns, SidesPointOutwardsEitherWayRound) {
  for (const bool clockwise : {false, true}) {
    const RoofTarget t{"a", {{10, 10, 5}, {30, 10, 5}, {30, 20, 5}, {10, 20, 5}}, 0.01};
    RoofTarget turned = t;
    if (clockwise) std::reverse(turned.corners.begin(), turned.corners.end());
    const std::vector<RoofSide> sides = sides_of(turned);
    ASSERT_EQ(sides.size(), 4u);
    const Vector2d middle = Vector2d(20, 15) - turned.corners[0].head<2>();
    for (const RoofSide& s : sides) EXPECT_LT(s.out.dot(middle - s.from), 0.0);
    EXPECT_NEAR(place_at(sides, middle).out, -5.0, 1e-12);
    const PlaceAtRoof beyond = place_at(sides, middle + Vector2d(2.0, 6.5));
    EXPECT_NEAR(beyond.out, 1.5, 1e-12);
    EXPECT_NEAR(beyond.from_end, 8.0, 1e-12);
    EXPECT_LT(place_at(sides, middle + Vector2d(11.0, 6.0)).from_end, 0.0);
  }
}

TEST(RoofReturns, ABeamCrossesAnInclinedPlaneWhereItsLineDoes) {
  const RoofTarget t{"a", {{0, 0, 10}, {20, 0, 10}, {20, 8, 6}, {0, 8, 6}}, 0.01};
  const RoofPlane plane(t);
  EXPECT_NEAR(plane.at({5.0, 4.0}), 8.0, 1e-12);
  // From (10, 3, 8.5), which lies on the plane, on to the ground with 0.3 east and -0.2 north for each metre down.
  const double down = 8.5;
  RoofReturn r;
  r.x = static_cast<float>(10.0 + 0.3 * down), r.y = static_cast<float>(3.0 - 0.2 * down);
  r.above = static_cast<float>(0.0 - plane.at({10.0 + 0.3 * down, 3.0 - 0.2 * down}));
  r.run_x = 0.3F, r.run_y = -0.2F;
  EXPECT_NEAR((crossing_of(r, plane, 0.0) - Vector2d(10.0, 3.0)).norm(), 0.0, 1e-5);
}

TEST(RoofReturns, GroundBehindARoofBelongsToThePulseThatPassedIt) {
  const test::House house;
  test::Cloud cloud;
  test::Survey flown;
  flown.beam = flown.place = flown.range = 0.0;
  test::fly(flown, {house.body()}, house.middle, 40.0, 3, cloud);
  const std::vector<RoofTarget> targets{house.target("house")};
  const auto all = first_of_pulses(returns_at_roofs(cloud.block, cloud.block.size(), cloud.scanner, targets));
  const RoofPlane plane(targets[0]);
  const std::vector<RoofSide> sides = sides_of(targets[0]);
  size_t over = 0, beyond = 0;
  for (const RoofReturn& r : all) {
    const double out = place_at(sides, crossing_of(r, plane, 0.0)).out;
    if (std::abs(out) < 1e-3) continue;
    EXPECT_EQ(std::abs(r.above) < 1e-3, out < 0.0) << r.x << " " << r.y << " " << r.above;
    ++(out < 0.0 ? over : beyond);
  }
  EXPECT_NEAR(static_cast<double>(over), 8.0 * 800.0, 0.02 * 8.0 * 800.0);
  EXPECT_GT(beyond, 1500u);
}

TEST(RoofReturns, OfAPulseTheFirstReturnStandsAndTheOrderDoesNotMatter) {
  std::vector<RoofReturn> returns(3);
  returns[0].time = 2.0, returns[0].number = 2;
  returns[1].time = 2.0, returns[1].number = 1;
  returns[2].time = 1.0, returns[2].number = 1;
  for (int k = 0; k < 2; ++k) {
    const auto first = first_of_pulses(returns);
    ASSERT_EQ(first.size(), 2u);
    EXPECT_EQ(first[0].time, 1.0);
    EXPECT_EQ(first[1].number, 1);
    std::reverse(returns.begin(), returns.end());
  }
}

TEST(RoofReturns, OwnPointsWithAPlaceOfTheScannerCountAlone) {
  const test::House house;
  test::Cloud cloud;
  test::fly({}, {house.body()}, house.middle, 30.0, 3, cloud);
  const std::vector<RoofTarget> targets{house.target("house")};
  const size_t all = returns_at_roofs(cloud.block, cloud.block.size(), cloud.scanner, targets).size();
  const size_t half = returns_at_roofs(cloud.block, cloud.block.size() / 2, cloud.scanner, targets).size();
  EXPECT_LT(half, all);
  for (Vector3d& s : cloud.scanner) s.setConstant(std::nan(""));
  EXPECT_TRUE(returns_at_roofs(cloud.block, cloud.block.size(), cloud.scanner, targets).empty());
  EXPECT_TRUE(is_near(targets[0], {0.0, 0.0, 100.0, 100.0}));
  EXPECT_FALSE(is_near(targets[0], {500.0, 0.0, 600.0, 100.0}));
  const RoofTarget hall{"hall", {{0, 0, 9}, {600, 0, 9}, {600, 40, 9}, {0, 40, 9}}, 0.01};
  EXPECT_TRUE(is_near(hall, {250.0, 0.0, 350.0, 100.0})) << "no corner is near";
}

}  // namespace
}  // namespace swath::quality
