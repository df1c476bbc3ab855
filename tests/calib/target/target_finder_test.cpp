// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_finder.h"

#include <gtest/gtest.h>

#include "tests/calib/box_flight.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace test;

constexpr double cell = 2.0;  // m: what the finder can know

TEST(TargetFinder, FindsTheHallAmongItsNeighbours) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  f.shed = 5.0;
  f.truth.roll.value = 0.006;  // lines are displaced by metres with the calibration in force
  const BoxRecords r = fly(f);
  const core::Scanner scanner;
  const ShotGeometry geometry(scanner, {});
  const trajectory::Trajectory trajectory(r.delivered);
  const auto shots = r.stream();
  const auto t = find_roof(shots, geometry, trajectory, 0.012);
  ASSERT_TRUE(t);
  EXPECT_FALSE(t->surveyed);
  ASSERT_EQ(t->sides(), 4u);
  EXPECT_NEAR((t->corners[1] - t->corners[0]).norm() * (t->corners[2] - t->corners[1]).norm(), 60.0 * 32.0,
              92.0 * cell);  // a cell's width around
  const Vector3d centre = r.frame.local_R_ecef * (t->frame.origin - r.frame.origin);
  EXPECT_LT(centre.head<2>().norm(), 6.0);
  EXPECT_NEAR(centre.z(), f.roof, 1.0);
  const Vector2d side = t->corners[1] - t->corners[0];
  const double azimuth = std::atan2(side.x(), side.y());
  EXPECT_LT(std::abs(std::sin(2.0 * (azimuth - f.azimuth))), 0.08);
}

// 0.3 returns per m2: of the least cells a third would be empty, and no patch would hang together.
TEST(TargetFinder, FindsTheHallInSparseLines) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  f.spacing = 1.8;
  const BoxRecords r = fly(f);
  const core::Scanner scanner;
  const ShotGeometry geometry(scanner, {});
  const trajectory::Trajectory trajectory(r.delivered);
  const auto t = find_roof(r.stream(), geometry, trajectory, 0.012);
  ASSERT_TRUE(t);
  const double side = 3.4;  // m: the widest cells
  EXPECT_NEAR((t->corners[1] - t->corners[0]).norm() * (t->corners[2] - t->corners[1]).norm(), 60.0 * 32.0, 92.0 * side);
}

TEST(TargetFinder, FlatGroundIsNoRoof) {
  BoxFlight f;
  f.lines = {{1, 0.5, 0.0, 700.0}};
  f.roof = 1.5;
  const BoxRecords r = fly(f);
  const core::Scanner scanner;
  const ShotGeometry geometry(scanner, {});
  const trajectory::Trajectory trajectory(r.delivered);
  const auto shots = r.stream();
  EXPECT_FALSE(find_roof(shots, geometry, trajectory, 0.012));
  FinderOptions lower;
  lower.stands_out = 1.0;
  EXPECT_TRUE(find_roof(shots, geometry, trajectory, 0.012, lower));
  FinderOptions longer;
  longer.stands_out = 1.0;
  longer.shortest = 40.0;
  EXPECT_FALSE(find_roof(shots, geometry, trajectory, 0.012, longer));
}

TEST(TargetFinder, GridsTellRoofsFromWhatOnlyLooksLikeThem) {
  const auto fill = [](HeightGrid& g, const std::function<double(double, double)>& up) {
    for (double x = -60.0; x < 60.0; x += 0.7)
      for (double y = -60.0; y < 60.0; y += 0.7) g.add({x, y, up(x, y)});
  };
  const auto within = [](double x, double y, double a, double b) { return std::abs(x) < a && std::abs(y) < b; };
  HeightGrid hall(cell), gable(cell), round(cell), cut(cell);
  fill(hall, [&](double x, double y) { return within(x, y, 25, 15) ? 8.0 : 0.0; });
  const auto found = hall.roofs({});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].half.x(), 25.0, 1.5);
  EXPECT_NEAR(found[0].half.y(), 15.0, 1.5);
  EXPECT_NEAR(found[0].plane[0], 8.0, 1e-6);
  EXPECT_NEAR(std::abs(std::sin(found[0].azimuth)), 1.0, 1e-3);  // its longer side lies east
  fill(gable, [&](double x, double y) { return within(x, y, 25, 15) ? 12.0 - 0.4 * std::abs(y) : 0.0; });
  EXPECT_TRUE(gable.roofs({}).empty());
  fill(round, [&](double x, double y) { return std::hypot(x, y) < 20 || (x > 0 && x < 50 && std::abs(y) < 4) ? 8.0 : 0.0; });
  EXPECT_TRUE(round.roofs({}).empty());
  // At the swath's end: where it ends is not known.
  for (double x = -60.0; x < 10.0; x += 0.7)
    for (double y = -13.0; y < 13.0; y += 0.7) cut.add({x, y, x > -25.0 ? 8.0 : 0.0});
  EXPECT_TRUE(cut.roofs({}).empty());
}

}  // namespace
}  // namespace swath::calib
