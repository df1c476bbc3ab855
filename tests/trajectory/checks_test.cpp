// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/config/result_visitors.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

constexpr double deg = core::degree;

// 60 m/s towards `track`, nose turned into the wind by `crab`.
core::TrajectoryData line(double track, double crab, size_t n = 2000) {
  core::TrajectoryData d;
  double latitude = 48.0 * deg, longitude = 11.0 * deg;
  for (size_t i = 0; i < n; ++i) {
    const double s = static_cast<double>(i) * 0.005;
    d.time.push_back(1.4e9 + s);
    d.latitude.push_back(latitude);
    d.longitude.push_back(longitude);
    d.height.push_back(1200.0);
    d.roll.push_back(0.5 * deg * std::sin(s));
    d.pitch.push_back(2.0 * deg);
    d.heading.push_back(core::wrap_two_pi(track + crab + 0.2 * deg * std::sin(3.0 * s)));
    d.v_north.push_back(60.0 * std::cos(track));
    d.v_east.push_back(60.0 * std::sin(track));
    d.v_down.push_back(0.0);
    latitude += 0.005 * 60.0 * std::cos(track) / (core::meridian_radius(latitude) + 1200.0);
    longitude += 0.005 * 60.0 * std::sin(track) / ((core::prime_vertical_radius(latitude) + 1200.0) * std::cos(latitude));
  }
  return d;
}

TEST(TrajectoryChecks, CrabAngleIsMeasured) {
  const TrajectoryChecks c = check_trajectory(line(178.0 * deg, 5.0 * deg));
  EXPECT_TRUE(c.warnings.empty()) << c.warnings[0];
  EXPECT_GT(c.straight, 1800u);
  EXPECT_NEAR(core::to_degrees(c.crab_median), 5.0, 0.15);
  EXPECT_NEAR(core::to_degrees(c.crab_spread), 0.2, 0.1);
  EXPECT_NEAR(c.speed_median, 60.0, 0.05);
  EXPECT_NEAR(c.rate, 200.0, 0.1);
  EXPECT_LT(c.velocity_difference, 0.05);
}

// Line and line back.
core::TrajectoryData there_and_back(double track, double crab) {
  core::TrajectoryData d = line(track, crab);
  const core::TrajectoryData back = line(track + core::pi, -crab);
  const double later = d.time.back() - d.time.front() + 60.0;
  const auto add = [](std::vector<double>& to, const std::vector<double>& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(d.time, back.time);
  for (size_t i = d.size() - back.size(); i < d.size(); ++i) d.time[i] += later;
  add(d.latitude, back.latitude), add(d.longitude, back.longitude), add(d.height, back.height);
  add(d.roll, back.roll), add(d.pitch, back.pitch), add(d.heading, back.heading);
  add(d.v_north, back.v_north), add(d.v_east, back.v_east), add(d.v_down, back.v_down);
  return d;
}

TEST(TrajectoryChecks, WindOnALineAndTheLineBackIsNoScatter) {
  const TrajectoryChecks c = check_trajectory(there_and_back(60.0 * deg, 12.0 * deg));
  ASSERT_EQ(c.warnings.size(), 1u) << "the gap between the lines alone";
  EXPECT_NE(c.warnings[0].find("1 gap"), std::string::npos);
  EXPECT_LT(core::to_degrees(c.crab_spread), 0.5);
  EXPECT_GT(core::to_degrees(c.crab_range), 10.0);
}

TEST(TrajectoryChecks, HeadingWithTheWrongSignIsSeen) {
  core::TrajectoryData d = there_and_back(60.0 * deg, 2.0 * deg);
  for (double& h : d.heading) h = core::wrap_two_pi(-h);
  bool heading = false;
  for (const std::string& w : check_trajectory(d).warnings) heading = heading || w.find("heading") != std::string::npos;
  EXPECT_TRUE(heading);
}

TEST(TrajectoryChecks, WanderAngleLeftInIsSeen) {
  const TrajectoryChecks c = check_trajectory(line(90.0 * deg, 103.0 * deg));
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("wander"), std::string::npos);
}

TEST(TrajectoryChecks, VelocityOfAnotherFrameIsSeen) {
  core::TrajectoryData d = line(90.0 * deg, 0.0);
  std::swap(d.v_north, d.v_east);
  const TrajectoryChecks c = check_trajectory(d);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("velocity"), std::string::npos);
}

TEST(TrajectoryChecks, DegreesAndRadiansAreSeen) {
  core::TrajectoryData d = line(90.0 * deg, 0.0);
  for (auto* c : {&d.roll, &d.pitch, &d.heading})
    for (double& v : *c) v /= deg;
  EXPECT_NE(check_trajectory(d).warnings.at(0).find("degrees read as radians"), std::string::npos);
  d = line(90.0 * deg, 0.0);
  for (auto* c : {&d.roll, &d.pitch, &d.heading})
    for (double& v : *c) v *= deg;
  EXPECT_NE(check_trajectory(d).warnings.at(0).find("radians read as degrees"), std::string::npos);
}

TEST(TrajectoryChecks, GapsDuplicatesAndJumpsAreCounted) {
  core::TrajectoryData d = line(0.0, 0.0);
  for (size_t i = 1000; i < d.size(); ++i) d.time[i] += 3.0;
  d.time[11] = d.time[10];
  d.time[500] = d.time[499] - 0.001;
  d.roll[700] = std::numeric_limits<double>::quiet_NaN();
  const TrajectoryChecks c = check_trajectory(d);
  ASSERT_EQ(c.gaps.size(), 1u);
  EXPECT_EQ(c.gaps[0].record, 999u);
  EXPECT_NEAR(c.gaps[0].length, 3.005, 1e-6);
  EXPECT_EQ(c.duplicates, 1u);
  EXPECT_EQ(c.backwards, 1u);
  EXPECT_EQ(c.not_finite, 1u);
  EXPECT_EQ(c.warnings.size(), 4u);
  EXPECT_EQ(core::reported(c).find("gaps")->items().size(), 1u);
}

/// Steps of 0.1 s at GPS times of 1.3e9 s, of which a double holds 2.4e-7 s.
TEST(TrajectoryChecks, StepsAsLongAsTheLongestAreNoGaps) {
  core::TrajectoryData d = line(10.0 * deg, 0.0, 200);
  for (size_t i = 0; i < d.size(); ++i) d.time[i] = 1330560000.0 + 0.1 * static_cast<double>(i);
  EXPECT_TRUE(check_trajectory(d).gaps.empty());
}

TEST(TrajectoryChecks, TurnsAndStandingAreLeftOut) {
  core::TrajectoryData d = line(0.0, 0.0);
  for (double& r : d.roll) r = 25.0 * deg;
  EXPECT_EQ(check_trajectory(d).straight, 0u);
  d = line(0.0, 0.0);
  for (double& l : d.latitude) l = d.latitude[0];
  EXPECT_EQ(check_trajectory(d).straight, 0u);
  EXPECT_EQ(check_trajectory({}).records, 0u);
}

}  // namespace
}  // namespace swath::trajectory
