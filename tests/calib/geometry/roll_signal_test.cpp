// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/roll_signal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

std::optional<RollSignal> signal(const GateFlight& f, double late) {
  std::vector<PassSample> profiles;
  for (size_t k = 0; k < f.shots.size(); ++k) {
    core::Shots thin;
    for (size_t i = 0; i < f.shots[k].size(); i += 23) {
      thin.time.push_back(f.shots[k].time[i] + late);
      thin.angle.push_back(f.shots[k].angle[i]);
      thin.range.push_back(f.shots[k].range[i]);
    }
    profiles.push_back({k, std::move(thin)});
  }
  return roll_signal(profiles, ShotGeometry(f.chain.scanner, f.chain.calibration), f.data, 0.9);
}

TEST(RollSignal, LevelGroundTiltsAsTheAircraftRolls) {
  const auto s = signal(GateFlight(true), 0.0);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->factor, 1.0, 0.1);
  EXPECT_GT(s->correlation, 0.95);
  EXPECT_NEAR(s->offset, 0.0, 0.021);
}

TEST(RollSignal, ASignTurnsItRound) {
  GateFlight f(true);
  for (double& r : f.data.roll) r = -r;
  const auto s = signal(f, 0.0);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->factor, -1.0, 0.1);
}

TEST(RollSignal, LateTimesAreFound) {
  const auto s = signal(GateFlight(true), 0.5);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->offset, -0.5, 0.05);
  EXPECT_GT(s->best, s->correlation + 0.2);
}

TEST(RollSignal, AShortLineOverRoughSlopesIsUnsure) {
  // One line of 8 s whose slopes to either side, each as long as half a roll, are against the roll by chance.
  GateFlight f(true, 1);
  core::Shots& s = f.shots[0];
  for (size_t i = 0; i < s.size(); ++i) s.range[i] *= 1 + std::copysign(0.3, std::sin(2.1 * s.time[i] + 0.5)) * std::tan(s.angle[i]);
  auto r = signal(f, 0.0);
  if (r && r->factor > 0) {
    for (size_t i = 0; i < s.size(); ++i) s.range[i] *= 1 - 2 * std::copysign(0.3, std::sin(2.1 * s.time[i] + 0.5)) * std::tan(s.angle[i]);
    r = signal(f, 0.0);
  }
  ASSERT_TRUE(r);
  EXPECT_LT(r->factor, -1.0);
  EXPECT_GT(r->factor + 5 * r->sigma, -0.4) << r->factor << " +- " << r->sigma;
}

TEST(RollSignal, NoneWithoutRoll) {
  GateFlight f(true);
  for (double& r : f.data.roll) r = 0.0;
  EXPECT_FALSE(signal(f, 0.0));
}

}  // namespace
}  // namespace swath::calib
