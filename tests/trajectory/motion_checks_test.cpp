// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/motion_checks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

constexpr double deg = core::degree;
constexpr double speed = 60.0, gravity = 9.81, step = 0.02;
constexpr core::MetresPerSecond slowest{10.0};

// A flight that weaves: course turns to and fro with banks up to 25 deg, heights wave by 5 m; `lean`: roll per bank.
core::TrajectoryData weaving(double lean, double height_factor = 1.0) {
  core::TrajectoryData d;
  double latitude = 48.0 * deg, longitude = 11.0 * deg, course = 0.0;
  for (size_t i = 0; i < 6000; ++i) {
    const double t = static_cast<double>(i) * step;
    const double bank = 25.0 * deg * std::sin(0.1 * t), height = 1000.0 + 5.0 * std::sin(0.2 * t);
    d.time.push_back(1.4e9 + t);
    d.latitude.push_back(latitude);
    d.longitude.push_back(longitude);
    d.height.push_back(height * height_factor);
    d.roll.push_back(lean * bank + 0.5 * deg * std::sin(1.3 * t));
    d.pitch.push_back(2.0 * deg + 0.5 * deg * std::sin(0.7 * t));
    d.heading.push_back(core::wrap_two_pi(course));
    d.v_north.push_back(speed * std::cos(course));
    d.v_east.push_back(speed * std::sin(course));
    d.v_down.push_back(-5.0 * 0.2 * std::cos(0.2 * t));
    latitude += step * speed * std::cos(course) / (core::meridian_radius(latitude) + height);
    longitude += step * speed * std::sin(course) / ((core::prime_vertical_radius(latitude) + height) * std::cos(latitude));
    course += step * gravity * std::tan(bank) / speed;
  }
  return d;
}

TEST(MotionChecks, AnAircraftBanksIntoItsTurns) {
  const MotionChecks c = check_motion(weaving(1.0), slowest);
  EXPECT_TRUE(c.warnings.empty()) << c.warnings[0];
  EXPECT_GT(c.turning, 60.0);
  EXPECT_NEAR(c.roll_per_bank, 1.0, 0.03);
  EXPECT_NEAR(c.pitch_per_bank, 0.0, 0.1);
  EXPECT_NEAR(c.climb_ratio, 1.0, 0.01);
}

TEST(MotionChecks, RollWithTheWrongSignIsNamed) {
  const MotionChecks c = check_motion(weaving(-1.0), slowest);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("sign of roll"), std::string::npos);
}

TEST(MotionChecks, RollAndPitchSwappedAreNamed) {
  core::TrajectoryData d = weaving(1.0);
  std::swap(d.roll, d.pitch);
  const MotionChecks c = check_motion(d, slowest);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("swapped"), std::string::npos);
}

TEST(MotionChecks, ACarLeansOutwards) {
  EXPECT_TRUE(check_motion(weaving(-0.1), slowest).warnings.empty());
  EXPECT_TRUE(check_motion(weaving(0.0), slowest).warnings.empty());
}

TEST(MotionChecks, HeightsInFeetAreNamedByTheVerticalVelocity) {
  const MotionChecks c = check_motion(weaving(1.0, 1.0 / 0.3048), slowest);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("feet"), std::string::npos);
  core::TrajectoryData up = weaving(1.0);
  for (double& v : up.v_down) v = -v;
  ASSERT_EQ(check_motion(up, slowest).warnings.size(), 1u);
  EXPECT_NE(check_motion(up, slowest).warnings[0].find("counted up"), std::string::npos);
}

TEST(MotionChecks, LevelFlightAndMissingVelocitiesSayNothing) {
  core::TrajectoryData d = weaving(1.0, 1.0 / 0.3048);
  d.v_north.clear(), d.v_east.clear(), d.v_down.clear();
  EXPECT_TRUE(check_motion(d, slowest).warnings.empty());
  EXPECT_EQ(check_motion(d, slowest).climb_ratio, 0.0);
  EXPECT_TRUE(check_motion({}, slowest).warnings.empty());
  d = weaving(1.0);
  for (double& t : d.time) t = d.time[0];
  EXPECT_TRUE(check_motion(d, slowest).warnings.empty());
}

}  // namespace
}  // namespace swath::trajectory
