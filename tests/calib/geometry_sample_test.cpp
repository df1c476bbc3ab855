// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry_sample.h"

#include <gtest/gtest.h>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

const GateFlight& flight() {
  static const GateFlight f;
  return f;
}

TEST(GeometrySample, StretchesLieWhereTracksAreNear) {
  const trajectory::Trajectory t(flight().data);
  SampleSize size;
  size.returns = 3000;
  const SamplePlan plan = plan_sample(flight().lines, t, GateFlight::local(), 0.0, 300.0, size);
  ASSERT_EQ(plan.passes.size(), 3u);
  EXPECT_NEAR(plan.passes[0].speed, 50.0, 0.5);
  EXPECT_NEAR(plan.covered, 1.0, 1e-9);
  EXPECT_LT(plan.nearest, 15.0);  // the cross line meets the others
  size_t profiles = 0;
  for (const Stretch& s : plan.stretches) {
    EXPECT_GE(s.first, plan.passes[s.pass].first);
    EXPECT_LE(s.last, plan.passes[s.pass].last);
    profiles += s.profile;
  }
  EXPECT_EQ(profiles, 3u);
  const GeometrySample sample = collect_sample(plan, flight().input(t).shots);
  ASSERT_EQ(sample.surfaces.size(), 3u);
  size_t kept = 0;
  for (const PassSample& s : sample.surfaces) kept += s.shots.size();
  EXPECT_LT(kept, 80000u);  // of 360 000
  EXPECT_GT(kept, 10000u);
}

TEST(GeometrySample, NoMoreStretchesThanAllowed) {
  const trajectory::Trajectory t(flight().data);
  SampleSize size;
  size.most_stretches = 2;
  size_t surfaces = 0;
  for (const Stretch& s : plan_sample(flight().lines, t, GateFlight::local(), 0.0, 300.0, size).stretches) surfaces += !s.profile;
  EXPECT_LE(surfaces, 2u + 2u * static_cast<size_t>(size.sites));
}

TEST(GeometrySample, TimesOutsideTheTrajectoryAreNotCovered) {
  const trajectory::Trajectory t(flight().data);
  const SamplePlan plan = plan_sample(flight().lines, t, GateFlight::local(), 1e5, 300.0, {});
  EXPECT_EQ(plan.covered, 0.0);
  EXPECT_TRUE(plan.passes.empty());
}

TEST(GeometrySample, ThePieceOfTheTrajectoryHoldsTheStretches) {
  const trajectory::Trajectory t(flight().data);
  const SamplePlan plan = plan_sample(flight().lines, t, GateFlight::local(), 0.0, 300.0, {});
  const core::TrajectoryData piece = cut_trajectory(flight().data, plan, 0.0, 0.5);
  ASSERT_GT(piece.size(), 100u);
  ASSERT_EQ(piece.roll.size(), piece.size());
  for (size_t i = 1; i < piece.size(); ++i) ASSERT_LT(piece.time[i - 1], piece.time[i]);
  const trajectory::Trajectory part(piece);
  for (const Stretch& s : plan.stretches) EXPECT_TRUE(part.covers(s.first) && part.covers(s.last));
}

}  // namespace
}  // namespace swath::calib
