// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/roof_target.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/calib/box_flight.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace test;

TEST(RoofTarget, CornersInAnySense) {
  BoxFlight f;
  f.lines = {{1, 0.0, 0.0, 700.0}};
  const BoxRecords r = fly(f);
  std::vector<Vector3d> corners;
  for (const io::ControlPoint& p : r.control) corners.push_back(p.ecef);
  const RoofTarget a = roof_target("a", corners, 0.02, 0.02);
  std::reverse(corners.begin(), corners.end());
  const RoofTarget b = roof_target("b", corners, 0.02, 0.02);
  for (const RoofTarget& t : {a, b}) {
    EXPECT_TRUE(t.holds(t.centre()));
    EXPECT_TRUE(t.holds({10.0, 5.0}));
    EXPECT_FALSE(t.holds({60.0, 0.0}));
    EXPECT_LT(std::abs(t.plane[0]), 1e-3);
  }
  std::swap(corners[0], corners[1]);
  EXPECT_THROW(roof_target("crossed", corners, 0.02, 0.02), core::Error);
  corners.resize(2);
  EXPECT_THROW(roof_target("two", corners, 0.02, 0.02), core::Error);
}

TEST(RoofTarget, SidesAndArea) {
  RoofTarget t;
  t.corners = {{0, 0}, {8, 0}, {8, 3}, {0, 3}};
  EXPECT_DOUBLE_EQ(t.area(), 24.0);
  const RoofTarget::Side east = t.side(1);
  EXPECT_EQ(east.middle, Vector2d(8, 1.5));
  EXPECT_EQ(east.along, Vector2d(0, 1));
  EXPECT_EQ(east.outward, Vector2d(1, 0));
  EXPECT_DOUBLE_EQ(east.length, 3.0);
  EXPECT_EQ(t.side(3).outward, Vector2d(-1, 0)) << "the last side goes back to the first corner";
  EXPECT_TRUE(t.holds({7.9, 2.9}));
  EXPECT_FALSE(t.holds({8.1, 2.9}));
}

}  // namespace
}  // namespace swath::calib
