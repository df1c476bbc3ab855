// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

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
  const GeometrySample sample = collect_samples({&plan}, flight().input(t).shots).front();
  ASSERT_EQ(sample.surfaces.size(), 3u);
  size_t kept = 0;
  for (const PassSample& s : sample.surfaces) kept += s.shots.size();
  EXPECT_LT(kept, 80000u);  // of 360 000
  EXPECT_GT(kept, 10000u);
}

TEST(GeometrySample, ALineInTwoFilesIsNotComparedWithItself) {
  const trajectory::Trajectory t(flight().data);
  const GateFlight one(false, 1);
  const RecordedLine& l = one.lines[0];
  const RecordedLine channels[] = {{1, l.first, l.last, l.records / 2}, {1, l.first + 0.01, l.last, l.records / 2}};
  const RecordedLine parts[] = {{1, 4 + l.first, l.last, l.records / 2}, {1, l.first, 3.9 + l.first, l.records / 2}};
  for (const auto& lines : {channels, parts}) {
    const SamplePlan plan = plan_sample({lines[0], lines[1]}, t, GateFlight::local(), 0.0, 300.0, {});
    EXPECT_EQ(plan.passes.size(), 1u);
    EXPECT_GT(plan.nearest, 1e9);
    for (const Stretch& s : plan.stretches) EXPECT_TRUE(s.profile);
  }
  // Three seconds between the files: two passes, still of one line.
  const SamplePlan apart =
      plan_sample({{1, l.first, l.first + 2.5, 100}, {1, l.first + 5.5, l.last, 100}}, t, GateFlight::local(), 0.0, 300.0, {});
  EXPECT_EQ(apart.passes.size(), 2u);
  EXPECT_GT(apart.nearest, 1e9);
}

TEST(GeometrySample, ReturnsOfTwoFilesAreByTime) {
  const trajectory::Trajectory t(flight().data);
  const SamplePlan plan = plan_sample(flight().lines, t, GateFlight::local(), 0.0, 300.0, {});
  const ShotStream halves = [&](const std::function<void(int, const core::Shots&)>& work) {
    for (const size_t first : {size_t{1}, size_t{0}}) {
      core::Shots half;
      const core::Shots& all = flight().shots[0];
      for (size_t i = first; i < all.size(); i += 2)
        half.time.push_back(all.time[i]), half.angle.push_back(all.angle[i]), half.range.push_back(all.range[i]);
      if (first == 0) half.forward.assign(half.size(), 0.1);
      work(flight().lines[0].line, half);
    }
  };
  const GeometrySample sample = collect_samples({&plan}, halves).front();
  ASSERT_FALSE(sample.surfaces.empty());
  for (const PassSample& s : sample.surfaces) {
    EXPECT_TRUE(std::is_sorted(s.shots.time.begin(), s.shots.time.end()));
    EXPECT_EQ(s.shots.forward.size(), s.shots.time.size());
  }
}

TEST(GeometrySample, PairsOfAThousandLinesAreFoundAtOnce) {
  // Turned by 45 deg, so that all boxes of tracks meet.
  core::TrajectoryData d;
  std::vector<RecordedLine> lines;
  constexpr double speed = 50, taken = 200, spacing = 300;
  const core::Geodetic at = core::geodetic_of(GateFlight::local().to_ecef({0, 0, 300}));
  for (int k = 0; k < 1000; ++k) {
    const double start = 1000 + 300.0 * k;
    for (int i = 0; i <= static_cast<int>(taken) + 2; ++i) {
      const double s = i - 1, along = (k % 2 ? taken - s : s) * speed, across = k * spacing, turned = std::sqrt(0.5);
      d.time.push_back(start + s);
      d.latitude.push_back(at.latitude + (along - across) * turned / 6.37e6);
      d.longitude.push_back(at.longitude + (along + across) * turned / (6.38e6 * std::cos(at.latitude)));
      d.height.push_back(at.height);
      for (const auto c : {&core::TrajectoryData::roll, &core::TrajectoryData::pitch, &core::TrajectoryData::heading}) (d.*c).push_back(0);
    }
    lines.push_back({k + 1, start, start + taken, 1000000});
  }
  trajectory::TrajectoryOptions how;
  how.max_gap = core::Seconds(1.5);
  const trajectory::Trajectory t(std::move(d), how);
  const auto began = std::chrono::steady_clock::now();
  const SamplePlan plan = plan_sample(lines, t, GateFlight::local(), 0.0, 300.0, {});
  EXPECT_EQ(plan.passes.size(), 1000u);
  EXPECT_NEAR(plan.nearest, spacing, 5.0);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 20.0);
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
