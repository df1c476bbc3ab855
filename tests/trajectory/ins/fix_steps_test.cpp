// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/fix_steps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/trajectory/ins_run.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using Eigen::Vector3d;
using test::lines_and_turns;
using test::motion_start;
using test::Trial;
using test::trial_of;

/// Fixes off by `ned` (m) between two instants of the motion, s.
std::function<void(core::GnssData&)> shifted(double from, double until, const Vector3d& ned) {
  return [=](core::GnssData& g) {
    for (size_t k = 0; k < g.size(); ++k)
      if (g.time[k] >= motion_start + from && g.time[k] < motion_start + until) g.position[k] += ned_at(g.position[k]) * ned;
  };
}

TEST(FixSteps, AreFoundWithSizeAndSigmaForEveryGrade) {
  const Vector3d step(0.02, 0.15, -0.05);
  for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Trial run = trial_of(grade, seed);
      run.change_gnss = shifted(119.9, 1e9, step);
      const std::vector<StepFound> found = run.on(lines_and_turns()).report.figures.steps;
      ASSERT_EQ(found.size(), 1u) << seed;
      EXPECT_NEAR(found[0].first - motion_start, 120.0, 0.4);
      EXPECT_LT((found[0].size - step).cwiseQuotient(found[0].sigma).cwiseAbs().maxCoeff(), 4.0) << found[0].size.transpose();
      EXPECT_LT(found[0].sigma.x(), 0.03);
    }
}

TEST(FixSteps, ThereAreNoneInACleanFlightNorInSingleWrongFixes) {
  for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical, ImuGrade::mems})
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      for (const double outliers : {0.0, 0.01}) {
        Trial run = trial_of(grade, seed);
        run.fixes.outliers = outliers;
        EXPECT_TRUE(run.on(lines_and_turns()).report.figures.steps.empty()) << seed << " " << outliers;
      }
}

TEST(FixSteps, SigmasBesideAStepAllowForIt) {
  // 15 cm for 40 s: the smoother keeps to the level of most of the time (2.1 cm; 8 where every fix is believed).
  test::Statistics within;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, seed);
    run.change_gnss = shifted(99.9, 139.9, {0.0, 0.15, 0.0});
    const InsGnssResult r = run.on(lines_and_turns());
    EXPECT_EQ(r.report.figures.steps.size(), 2u);
    EXPECT_NE(test::warning_with(r, "the fixes jump by"), "");
    within.add(r, lines_and_turns(), 100, 140);
  }
  EXPECT_GT(std::sqrt(within.normed[1] / within.count), 0.5);
  EXPECT_LT(within.rms()[1], 0.04);
  EXPECT_LT(std::sqrt(within.normed[1] / within.count), 1.4);
}

TEST(FixSteps, TheFirstLevelMayBeTheUnusualOne) {
  test::Statistics first;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, seed);
    run.change_gnss = shifted(-1e9, 59.9, {0.0, 0.15, 0.0});
    const InsGnssResult r = run.on(lines_and_turns());
    EXPECT_EQ(r.report.figures.steps.size(), 1u);
    first.add(r, lines_and_turns(), 0, 60);
  }
  EXPECT_LT(std::sqrt(first.normed[1] / first.count), 1.4);
  EXPECT_GT(std::sqrt(first.normed[1] / first.count), 0.4);
}

TEST(FixSteps, AllowancesAreThoseOfTheLevelsOwnFixes) {
  // Fixes of 2.5 cm that become fixes of 25 cm with a shift of 1 m: the usual level is the second, and the first is allowed its metre.
  test::Statistics first;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, seed);
    run.change_gnss = [&](core::GnssData& g) {
      test::Dice dice(seed + 50);
      for (size_t k = 0; k < g.size(); ++k) {
        if (g.time[k] < motion_start + 79.9) {
          g.position[k] += ned_at(g.position[k]) * Vector3d(0.0, 1.0, 0.0);
          continue;
        }
        g.position[k] += 0.25 * dice.vector();
        g.covariance[k] += 0.0625 * Eigen::Matrix3d::Identity();
      }
    };
    const InsGnssResult r = run.on(lines_and_turns());
    EXPECT_EQ(r.report.figures.steps.size(), 1u);
    first.add(r, lines_and_turns(), 0, 80);
  }
  EXPECT_LT(std::sqrt(first.normed[1] / first.count), 2.0);
}

}  // namespace
}  // namespace swath::trajectory
