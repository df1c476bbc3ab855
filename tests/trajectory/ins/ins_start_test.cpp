// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_start.h"

#include "core/geo/frames.h"
#include "tests/trajectory/ins_run.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using test::straight_line;
using test::Trial;
using test::trial_of;

/// A run along one line with the attitude given `off` from the truth (heading), with the sigmas.
Trial given(double off, double sigma_heading, std::uint64_t seed = 1) {
  Trial run = trial_of(ImuGrade::mems, seed);
  run.options.alignment = AlignmentMethod::given;
  const simulate::Pose pose = straight_line().motion(0).pose;
  run.options.given.roll = core::Radians(pose.attitude.roll);
  run.options.given.pitch = core::Radians(pose.attitude.pitch);
  run.options.given.heading = core::Radians(pose.attitude.heading + off);
  run.options.given.sigma_roll_pitch = core::degrees(0.05);
  run.options.given.sigma_heading = core::Radians(sigma_heading);
  return run;
}

TEST(InsStart, AGivenHeadingIsUsedWithItsSigma) {
  // Straight ahead a MEMS unit shows little of its heading: what is given decides, as far as it is said to be good.
  Trial automatic = trial_of(ImuGrade::mems, 1);
  const InsGnssResult without = automatic.on(straight_line());
  const double sigma = 0.02 * core::degree;
  double squares = 0;
  constexpr int seeds = 4;
  for (int seed = 1; seed <= seeds; ++seed) {
    test::Dice dice(static_cast<std::uint64_t>(900 + seed));
    const InsGnssResult r = given(sigma * dice.normal(), sigma, static_cast<std::uint64_t>(seed)).on(straight_line());
    EXPECT_LT(r.trajectory.sigma_heading[10], 1.05f * static_cast<float>(sigma));
    EXPECT_GT(without.trajectory.sigma_heading[10], 3 * r.trajectory.sigma_heading[10]);
    squares += std::pow(test::error_of(r.trajectory, 10, straight_line().motion)[5] / r.trajectory.sigma_heading[10], 2);
    EXPECT_EQ(test::warning_with(r, "given"), "");
  }
  std::printf("heading at the beginning: error/sigma %.2f; sigma without %.3f deg, with %.3f deg\n", std::sqrt(squares / seeds),
              without.trajectory.sigma_heading[10] / core::degree, sigma / core::degree);
  EXPECT_LT(std::sqrt(squares / seeds), 2.0);
}

TEST(InsStart, ALooseStatementGivesWayToTheRecords) {
  Trial run = given(3 * core::degree, 5 * core::degree);
  Trial automatic = trial_of(ImuGrade::mems, 1);
  const InsGnssResult a = run.on(straight_line()), b = automatic.on(straight_line());
  const double apart = std::abs(core::wrap_pi(a.trajectory.heading[2000] - b.trajectory.heading[2000]));
  EXPECT_LT(apart, 0.5 * b.trajectory.sigma_heading[2000]);
}

TEST(InsStart, AGivenAttitudeThatContradictsTheRecordsIsNamed) {
  const InsGnssResult r = given(3 * core::degree, 0.1 * core::degree).on(straight_line());
  EXPECT_NE(test::warning_with(r, "the given heading contradicts"), "");
  EXPECT_NEAR(r.report.figures.alignment.given_sigma.value()[2], 0.1, 1e-9);
}

TEST(InsStart, WhatIsGivenAtTheBeginningIsNotKnownAtTheEnd) {
  // The backward pass begins at the other end: there nothing is given, and straight ahead its heading is as uncertain as that of a run
  // without a given attitude, 0.6 deg. Begun with the given 2 arcsec it would stay within 0.25 deg of the forward pass.
  double squares = 0;
  constexpr int seeds = 3;
  for (int seed = 1; seed <= seeds; ++seed) {
    Trial run = given(0, 0.0005 * core::degree, static_cast<std::uint64_t>(seed));
    run.options.given.sigma_roll_pitch = core::degrees(0.0005);
    const InsGnssResult r = run.on(straight_line());
    const SeparationFigures separation = r.report.figures.separation.value();
    squares += std::pow(separation.attitude_rms[2] / 3600, 2);
    EXPECT_LT(separation.by_sigma.maxCoeff(), 1.0) << seed;
  }
  EXPECT_GT(std::sqrt(squares / seeds), 0.4);
}

TEST(InsStart, TheAttitudeIsForgottenOnlyWhereItIsNotGiven) {
  const Layout layout(false, false, false, false, false);
  StateMatrix stated = StateMatrix::Identity(layout.size, layout.size);
  const StateVector sigma = StateVector::Constant(layout.size, 0.01);
  EXPECT_DOUBLE_EQ(widened(stated, sigma, true)(Layout::attitude, Layout::attitude), 1.0);
  EXPECT_DOUBLE_EQ(widened(stated, sigma, false)(Layout::attitude, Layout::attitude), 0.01);
  Estimate a, b;
  a.nav.ecef_R_body = core::exp_so3(Eigen::Vector3d(0.01, 0, 0));
  EXPECT_NEAR(stated_mean(a, b, layout, true)[Layout::attitude], 0.01, 1e-12);
  EXPECT_EQ(stated_mean(a, b, layout, false)[Layout::attitude], 0.0);
}

}  // namespace
}  // namespace swath::trajectory
