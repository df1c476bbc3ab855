// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/flown_lines.h"

#include <gtest/gtest.h>

#include "tests/calib/survey_support.h"

namespace swath::calib {
namespace {

using namespace test;

/// Level flight due east at 50 m/s, 700 m above the ellipsoid.
core::TrajectoryData eastward(double start) {
  core::TrajectoryData d;
  const double radius = core::prime_vertical_radius(0.8) + 700.0;
  for (int i = 0; i <= 4000; ++i) {
    const double s = i * 0.005;
    d.time.push_back(start + s);
    d.latitude.push_back(0.8);
    d.longitude.push_back(0.2 + s * 50.0 / (radius * std::cos(0.8)));
    d.height.push_back(700.0);
    d.roll.push_back(0);
    d.pitch.push_back(0);
    d.heading.push_back(90 * deg);
  }
  return d;
}

TEST(FlownLines, CourseSpeedLengthAndHeight) {
  const trajectory::Trajectory trajectory(eastward(1000.0));
  const ShotGeometry geometry(scanner_of(core::ScannerModel::mirror, false), {});
  FlownLines flown(geometry, trajectory);
  core::Shots shots = zigzag(20001, 1004.0, 2000.0, 0.0);  // ten seconds
  for (size_t i = 0; i < shots.size(); ++i) shots.range[i] = 690.0 / std::cos(shots.angle[i]);
  flown.add(7, shots);
  flown.add(3, zigzag(10, 5000.0, 2000.0, 690.0));
  const std::vector<FlownLine> lines = flown.lines();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].id, 3);
  EXPECT_TRUE(std::isnan(lines[0].heading)) << "outside the trajectory";
  EXPECT_EQ(lines[0].returns, 10u);
  const FlownLine& line = lines[1];
  EXPECT_EQ(line.returns, 20001u);
  constexpr double sphere = 2e-4;  // rad: the way east along a parallel is no straight line
  EXPECT_NEAR(line.heading, 90 * deg, sphere);
  constexpr double chord = 0.01;  // m
  EXPECT_NEAR(line.length, 500.0, chord);
  EXPECT_NEAR(line.speed, 50.0, chord / 10);
  EXPECT_NEAR(line.height, 690.0, 1e-6);
  EXPECT_NEAR(line.width, 2 * 690.0 * std::tan(20 * deg), 2.0) << "one return in a hundred is looked at";
  EXPECT_NEAR(side_for(lines, 10), std::sqrt(10 * line.length * line.width / 20001), 1e-9) << "the line outside the trajectory has no area";
}

std::vector<FlownLine> lines_of(const std::vector<core::Shots>& shots) {
  const trajectory::Trajectory trajectory(eastward(1000.0));
  const ShotGeometry geometry(scanner_of(core::ScannerModel::mirror, false), {});
  FlownLines flown(geometry, trajectory);
  for (size_t k = 0; k < shots.size(); ++k) flown.add(static_cast<int>(k + 1), shots[k]);
  return flown.lines();
}

TEST(FlownLines, GoodRecordsPassTheirCheck) {
  EXPECT_TRUE(check_lines(lines_of({zigzag(4000, 1001, 1000, 690), zigzag(4000, 1006, 1000, 690)})).empty());
}

TEST(FlownLines, ConstantSaturatedMixedAndLostLinesAreNamed) {
  core::Shots constant = zigzag(4000, 1001, 1000, 690), saturated = zigzag(4000, 1006, 1000, 690);
  for (double& r : constant.range) r = 655.35;
  for (double& r : saturated.range) r = std::min(r, 705.0);
  std::vector<Finding> found = check_lines(lines_of({constant, saturated}));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].what.find("line 1: 100 % of the ranges repeat"), std::string::npos) << found[0].what;
  EXPECT_TRUE(found[0].refuses);
  EXPECT_NE(found[1].what.find("saturated"), std::string::npos) << found[1].what;
  found = check_lines(lines_of({zigzag(4000, 1001, 1000, 690), zigzag(4000, 1003, 1000, 690), zigzag(4000, 9003, 1000, 690)}));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].what, "line 3 lies outside the trajectory");
  EXPECT_EQ(found[1].what, "lines 1 and 2 lie in one another in time");
  EXPECT_FALSE(found[1].refuses);
}

}  // namespace
}  // namespace swath::calib
