// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/strips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/error.h"
#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using test::Flown;
using test::TieWorld;
using test::Track;

constexpr double line_shift = 0.08;  // m, sigma of each line's offset of the trajectory

TieWorld small_world() {
  TieWorld w;
  w.houses = test::village(12, 90.0, 3);
  w.prf = 8000.0;
  w.scans = 16.0;
  return w;
}

std::vector<Track> crossed_lines() {
  return {{{-60, 0}, 350, 0.0, 320}, {{60, 0}, 350, core::pi, 320}, {{0, 0}, 350, 0.5 * core::pi, 320}};
}

struct Survey {
  Survey(const TieWorld& w, const std::vector<Track>& tracks)
      : world(w), flown(test::fly(w, tracks, 5, line_shift)), trajectory(flown.data, {}, "test"), errors(trajectory.data(), model()) {
    flight.shots = flown.stream();
    flight.scanner = world.scanner;
    flight.start = world.truth;
    flight.sensor.range = core::Metres(world.range_noise);
    flight.trajectory = &trajectory;
    flight.errors = &errors;
    flight.frame = world.frame;
  }
  static trajectory::ErrorModelOptions model() {
    trajectory::ErrorModelOptions o;
    o.horizontal.value = o.vertical.value = 0.1;
    o.roll_pitch = core::degrees(0.001);
    o.heading = core::degrees(0.002);
    return o;
  }
  TieWorld world;
  Flown flown;
  trajectory::Trajectory trajectory;
  trajectory::ErrorModel errors;
  CalibrationFlight flight;
};

TEST(Strips, LinesMeetAfterwards) {
  const Survey s(small_world(), crossed_lines());
  core::Tally tally;
  std::vector<double> shares;
  std::set<std::string, std::less<>> steps;
  const AdjustedStrips out = adjust_strips(s.flight, {}, tally, [&](double share, std::string_view now) {
    shares.push_back(share);
    steps.emplace(now);
  });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_LT(shares.back(), 1.0);
  EXPECT_TRUE(steps.contains("round 1: planes") && steps.contains("round 2: adjustment"));
  ASSERT_EQ(out.differences.pairs.size(), 3u);
  EXPECT_GT(out.differences.all.rms_before, 0.03);
  // Means of some hundred returns of 2 cm.
  EXPECT_LT(out.differences.all.rms_after, 0.008);
  for (const Estimate& e : out.adjustment.estimates) EXPECT_FALSE(e.estimated);
  EXPECT_EQ(out.adjustment.calibration.roll.value, s.world.truth.roll.value);
  EXPECT_FALSE(out.notes.empty());
}

TEST(Strips, TheCorrectedTrajectoryIsTheOldOnePlusTheCorrections) {
  const Survey s(small_world(), crossed_lines());
  core::Tally tally;
  const AdjustedStrips out = adjust_strips(s.flight, {}, tally);
  ASSERT_TRUE(out.trajectory);
  ASSERT_EQ(out.trajectory->data().size(), s.trajectory.data().size());
  EXPECT_EQ(out.trajectory->spans(), s.trajectory.spans());
  for (const LineCorrection& c : out.adjustment.corrections) {
    ASSERT_FALSE(c.time.empty());
    const double t = 0.5 * (c.time.front() + c.time.back());
    const auto was = s.trajectory.pose_at(t), is = out.trajectory->pose_at(t);
    ASSERT_TRUE(was && is);
    const Eigen::Vector3d local = s.world.frame.local_R_ecef * (is->position - was->position);
    const size_t n = c.time.size();
    const double down = n % 2 ? c.value[n / 2][2] : 0.5 * (c.value[n / 2 - 1][2] + c.value[n / 2][2]);
    EXPECT_NEAR(-local.z(), down, 1e-4);
  }
}

TEST(Strips, DifferencesArePairwiseAndLeaveOutWhatWasRejected) {
  TieSet ties;
  ties.lines = {{4, 0, 1}, {7, 0, 1}, {9, 0, 1}};
  Adjustment a;
  const auto add = [&](std::uint32_t plane, std::uint32_t line, double before, double after, bool rejected = false) {
    GroupResidual g;
    g.plane = plane, g.line = line, g.returns = 50, g.before = before, g.after = after, g.rejected = rejected;
    a.groups.push_back(g);
  };
  add(0, 0, 0.05, 0.01), add(0, 1, -0.05, -0.01);
  add(1, 0, 0.01, 0.00), add(1, 1, -0.05, 0.02), add(1, 2, 1.0, 1.0, true);
  add(2, 2, 0.5, 0.5);
  const PlaneDifferences d = plane_differences(ties, a);
  ASSERT_EQ(d.pairs.size(), 1u);
  EXPECT_EQ(d.pairs[0].line_a, 4);
  EXPECT_EQ(d.pairs[0].line_b, 7);
  EXPECT_EQ(d.all.planes, 2u);
  EXPECT_NEAR(d.all.mean_before, 0.08, 1e-15);
  EXPECT_NEAR(d.all.rms_before, std::sqrt((0.01 + 0.0036) / 2), 1e-15);
  EXPECT_NEAR(d.all.rms_after, 0.02, 1e-15);
}

void expect_refused(const std::vector<Track>& tracks, const std::string& words) {
  const Survey s(small_world(), tracks);
  core::Tally tally;
  try {
    adjust_strips(s.flight, {}, tally);
    ADD_FAILURE() << "not refused";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(Strips, AScanAngleOfTheWrongSignIsRefused) {
  Survey s(small_world(), crossed_lines());
  for (auto& [id, shots] : s.flown.lines)
    for (double& a : shots.angle) a = -a;
  core::Tally tally;
  try {
    adjust_strips(s.flight, {}, tally);
    FAIL() << "not refused";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("sign of the scan angle"), std::string::npos) << e.what();
  }
}

TEST(Strips, OneLineIsRefused) { expect_refused({{{0, 0}, 350, 0.0, 320}}, "but one flight line"); }
TEST(Strips, LinesBesideEachOtherAreRefused) {
  expect_refused({{{-400, 0}, 350, 0.0, 320}, {{400, 0}, 350, 0.0, 320}}, "no plane was found that two lines have seen");
}

}  // namespace
}  // namespace swath::calib
