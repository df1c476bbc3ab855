// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_box.h"

#include <gtest/gtest.h>

#include <limits>

namespace swath::io {
namespace {

LasHeader header_with(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  LasHeader h;
  h.min = low, h.max = high;
  return h;
}

LasPoints points_at(const std::vector<Eigen::Vector3d>& places) {
  LasPoints p;
  resize(p, LasHeader{}, places.size());
  for (std::size_t i = 0; i < places.size(); ++i) p.x[i] = places[i].x(), p.y[i] = places[i].y(), p.z[i] = places[i].z();
  return p;
}

TEST(LasBox, PointsInItAndAStepBesideItAreRight) {
  LasBox box;
  box.add(points_at({{0, 0, 0}, {10, 10, 5}, {-0.001, 5, 5.001}}), header_with({0, 0, 0}, {10, 10, 5}), 0);
  EXPECT_EQ(box.outside(), 0u);
  EXPECT_EQ(box.fault(), "");
}

TEST(LasBox, PointsOutsideAreCountedWithShareDistanceAndFirstRecords) {
  const LasHeader h = header_with({0, 0, 0}, {10, 10, 5});
  LasBox box;
  std::vector<Eigen::Vector3d> some(96, {5, 5, 1});
  some[7] = {-2, 5, 1};
  box.add(points_at(some), h, 0);
  box.add(points_at({{5, 23.5, 1}, {5, 5, -1}, {5, 5, 9}, {5, 5, 1}}), h, 96);
  EXPECT_EQ(box.outside(), 4u);
  EXPECT_EQ(box.fault(), "4 of 100 points (4 %) lie outside the box of the header, by up to 13.5 in y: records 7, 96, 97");
}

TEST(LasBox, BoundsRoundedToFewerDigitsAreNotWrong) {
  const LasHeader h = header_with({0, 0, 0}, {10, 10, 5});  // cut to 1 cm, points in mm
  LasBox rounded, wrong;
  rounded.add(points_at({{10.009, 5, 1}, {5, -0.009, 1}, {5, 5, 1}}), h, 0);
  EXPECT_EQ(rounded.outside(), 2u);
  EXPECT_FALSE(rounded.is_wrong());
  core::Tally tally;
  rounded.count("a.las", tally);
  EXPECT_EQ(tally.of(outside_box), 2u);
  EXPECT_EQ(tally.of(wrong_box), 0u);
  wrong.add(points_at({{10.009, 5, 1}, {5, -0.011, 1}, {5, 5, 1}}), h, 0);
  EXPECT_TRUE(wrong.is_wrong());
  wrong.count("b.las", tally);
  EXPECT_EQ(tally.of(outside_box), 4u);
  EXPECT_EQ(tally.of(wrong_box), 1u);
}

TEST(LasBox, ABoxOfZerosIsNone) {
  LasBox box;
  box.add(points_at({{5e5, 5e6, 400}}), header_with({0, 0, 0}, {0, 0, 0}), 0);
  EXPECT_EQ(box.outside(), 1u);
  EXPECT_EQ(box.fault(), "the header states no box: its bounds are all 0");
  EXPECT_TRUE(box.is_wrong());
}

TEST(LasBox, ABoundThatIsNoNumberHoldsNothing) {
  LasBox box;
  box.add(points_at({{1, 1, 1}}), header_with({std::numeric_limits<double>::quiet_NaN(), 0, 0}, {10, 10, 5}), 3);
  EXPECT_EQ(box.fault(), "1 of 1 points (100 %) lie outside the box of the header: record 3");
  EXPECT_TRUE(box.is_wrong());
}

}  // namespace
}  // namespace swath::io
