// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/flat_target.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "core/error.h"
#include "tests/calib/box_flight.h"

namespace swath::calib {
namespace {

using namespace test;
constexpr double deg = core::degree, arc_second = deg / 3600.0;

FlatTarget analyse(const BoxFlight& f, const core::Calibration& in_force, const FlatTargetOptions& options = {}, bool surveyed = true) {
  const BoxRecords r = fly(f);
  const core::Scanner scanner;
  const trajectory::Trajectory trajectory(r.delivered);
  core::Tally tally;
  const auto shots = r.stream();
  return analyse_flat_target(shots, scanner, in_force, r.sigma, trajectory, r.covariance,
                             surveyed ? r.control : std::vector<io::ControlPoint>{}, options, tally);
}

bool says(const FlatTarget& t, const std::string& what) {
  for (const auto* said : {&t.findings, &t.notes})
    for (const std::string& f : *said)
      if (f.find(what) != std::string::npos) return true;
  return false;
}
std::string all_of(const FlatTarget& t) {
  std::string out;
  for (const std::string& f : t.findings) out += f + "\n";
  return out;
}

BoxFlight realistic() {
  BoxFlight f;
  f.lines = full_pattern(0.42);
  f.footprint = Footprint::jitter;
  f.divergence = 0.3e-3;
  f.position_error = 0.02, f.height_error = 0.03;
  f.level_error = 0.002 * deg, f.heading_error = 0.005 * deg;
  return f;
}

core::Calibration some_truth(swath::test::Dice& dice, double size) {
  core::Calibration c;
  const auto draw = [&] { return (2.0 * dice.uniform() - 1.0) * size; };
  c.roll.value = draw(), c.pitch.value = draw(), c.heading.value = draw();
  c.range_offset.value = 0.3 * (dice.uniform() - 0.5);
  return c;
}

TEST(FlatTarget, FindsSmallAndLargeAngles) {
  for (const double size : {0.5, -0.5, 0.02}) {
    BoxFlight f;
    f.lines = full_pattern(0.42);
    f.truth.roll.value = size * deg;
    f.truth.pitch.value = -size * deg;
    f.truth.heading.value = size * deg;
    f.truth.range_offset.value = 0.12;
    const FlatTarget t = analyse(f, {});
    ASSERT_TRUE(t.done) << all_of(t);
    SCOPED_TRACE(size);
    EXPECT_EQ(t.target.name, "hall");
    // Nothing but the edges is uncertain: 2 cm at 700 m, and at 210 m to the side.
    EXPECT_NEAR(t.measured.roll.value, f.truth.roll.value, 4.0 * arc_second);
    EXPECT_NEAR(t.measured.pitch.value, f.truth.pitch.value, 4.0 * arc_second);
    EXPECT_NEAR(t.measured.heading.value, f.truth.heading.value, 15.0 * arc_second);
    EXPECT_NEAR(t.measured.range_offset.value, 0.12, 0.005);
    for (const TargetAngle* a : {&t.roll, &t.pitch, &t.heading}) {
      EXPECT_TRUE(a->beyond);
      EXPECT_EQ(a->value, a->mean);
    }
    EXPECT_EQ(t.calibration.roll, t.measured.roll);
    for (const TargetLine& l : t.lines) {
      EXPECT_TRUE(l.measured);
      EXPECT_LT(l.after.displacement.cwiseAbs().maxCoeff(), 0.08);
      if (std::abs(size) > 0.1) {
        EXPECT_GT(l.before.displacement.norm(), 5.0);
      }
    }
    // Half a degree is where the formulas alone begin to err by more than the readings do.
    EXPECT_EQ(says(t, "small-angle formulas"), std::abs(size) > 0.1) << all_of(t);
  }
}

// Sums of (error / sigma)^2 over seeds.
struct Ratio {
  double sum = 0.0, squares = 0.0;
  int n = 0;
  void add(double error, double sigma) {
    sum += error * error / (sigma * sigma);
    squares += error * error;
    ++n;
  }
  double value() const { return std::sqrt(sum / n); }
  double rms() const { return std::sqrt(squares / n); }
};

void run_seeds(int seeds, bool surveyed) {
  Ratio roll, pitch, heading, range, scale;
  for (int seed = 1; seed <= seeds; ++seed) {
    BoxFlight f = realistic();
    f.seed = static_cast<std::uint64_t>(seed);
    swath::test::Dice dice(static_cast<std::uint64_t>(1000 + seed));
    f.truth = some_truth(dice, 0.5 * deg);
    f.datum = {0.2 * dice.normal(), 0.2 * dice.normal(), 0.0};
    const FlatTarget t = analyse(f, {}, {}, surveyed);
    ASSERT_TRUE(t.done) << all_of(t);
    ASSERT_TRUE(t.roll.determined && t.pitch.determined && t.heading.determined) << all_of(t);
    roll.add(t.roll.mean - f.truth.roll.value, t.roll.sigma);
    pitch.add(t.pitch.mean - f.truth.pitch.value, t.pitch.sigma);
    heading.add(t.heading.mean - f.truth.heading.value, t.heading.sigma);
    if (surveyed) range.add(t.range_mean - f.truth.range_offset.value, t.range_sigma);
    if (surveyed) scale.add(t.scan_scale - 1.0, t.scan_scale_sigma);
    EXPECT_EQ(t.range_determined, surveyed);
  }
  // Twelve values: error / sigma lies within 0.6 and 1.4 in 95 of 100 cases; four: within 0.35 and 1.7.
  const double low = seeds >= 12 ? 0.6 : 0.25, high = seeds >= 12 ? 1.4 : 1.8;
  const auto check = [&](const char* name, const Ratio& r, double unit) {
    std::cout << name << ": rms " << r.rms() / unit << ", error / sigma " << r.value() << "\n";
    EXPECT_GT(r.value(), low) << name;
    EXPECT_LT(r.value(), high) << name;
  };
  check("roll (arcsec)", roll, arc_second);
  check("pitch (arcsec)", pitch, arc_second);
  check("heading (arcsec)", heading, arc_second);
  if (surveyed) {
    check("range offset (cm)", range, 0.01);
    check("scan scale (ppm)", scale, 1e-6);
  }
}

int seeds_wanted() {
  const char* wanted = std::getenv("SWATH_FLAT_TARGET_SEEDS");
  return wanted ? std::atoi(wanted) : 4;
}

TEST(FlatTarget, ErrorsAreWhatTheirSigmasSay) { run_seeds(seeds_wanted(), true); }
TEST(FlatTarget, WithoutSurveyTheLinesAreComparedWithTheirMean) { run_seeds(seeds_wanted(), false); }

TEST(FlatTarget, SaysWhichPassIsMissing) {
  BoxFlight f = realistic();
  const double a = 0.42;
  f.lines = {{1, a, 0.0, 700.0}, {2, a, 210.0, 700.0}};
  FlatTarget t = analyse(f, {});
  ASSERT_TRUE(t.done);
  EXPECT_FALSE(t.pitch.determined);
  EXPECT_FALSE(t.roll.determined);
  EXPECT_TRUE(says(t, "pitch is not determined, no two lines in opposite directions")) << all_of(t);
  EXPECT_TRUE(says(t, "roll is not determined")) << all_of(t);
  EXPECT_EQ(t.calibration.pitch.value, 0.0);
  f.lines = {{1, a, 0.0, 700.0}, {2, a + core::pi, 0.0, 700.0}, {3, a, 900.0, 700.0}};
  t = analyse(f, {});
  EXPECT_TRUE(t.pitch.determined);
  EXPECT_FALSE(t.heading.determined);
  EXPECT_TRUE(says(t, "heading is not determined")) << all_of(t);
  EXPECT_TRUE(says(t, "line 3 takes no part, no returns near the target")) << all_of(t);
  // Half of the roof lies beyond the swath.
  f.lines = {{1, a, 0.0, 700.0}, {2, a + core::pi, 0.0, 700.0}, {3, a, 250.0, 700.0}, {4, a + core::pi, 250.0, 700.0}};
  t = analyse(f, {});
  EXPECT_TRUE(t.heading.determined) << all_of(t);
  EXPECT_TRUE(says(t, "line 3 sees 3 of the target's 4 edges")) << all_of(t);
  f.lines = {{1, a, 900.0, 700.0}};
  t = analyse(f, {});
  EXPECT_FALSE(t.done);
  EXPECT_TRUE(says(t, "no line sees the target")) << all_of(t);
}

TEST(FlatTarget, NewValuesOnlyBeyondTheTolerance) {
  BoxFlight f = realistic();
  f.truth.pitch.value = 0.05 * deg;
  const FlatTarget t = analyse(f, {});
  EXPECT_TRUE(t.pitch.beyond);
  EXPECT_FALSE(t.roll.beyond && t.heading.beyond);
  EXPECT_NEAR(t.calibration.pitch.value, f.truth.pitch.value, 4.0 * t.pitch.sigma);
  EXPECT_EQ(t.pitch.tolerance, 2.0 * t.pitch.sigma);
  FlatTargetOptions wide;
  wide.tolerance = core::degrees(0.1);
  const FlatTarget kept = analyse(f, {}, wide);
  EXPECT_FALSE(kept.pitch.beyond);
  EXPECT_EQ(kept.calibration.pitch.value, 0.0);
  EXPECT_NEAR(kept.pitch.mean, f.truth.pitch.value, 4.0 * kept.pitch.sigma);
}

TEST(FlatTarget, TwoHeightsAndALeverArm) {
  BoxFlight f = realistic();
  f.lines = full_pattern(0.42);
  for (const BoxLine& l : full_pattern(0.42, 1300.0, 11)) f.lines.push_back(l);
  f.spacing = 1.0;
  f.truth.pitch.value = 0.1 * deg;
  f.truth.lever_arm_scanner[0] = core::Metres(0.6);
  core::Calibration in_force;
  FlatTarget t = analyse(f, in_force);
  EXPECT_TRUE(t.joint.two_heights);
  EXPECT_TRUE(t.pitch.of_two_heights);
  EXPECT_TRUE(says(t, "lever arm +0.")) << all_of(t);
  EXPECT_NEAR(-t.joint.lever_forward.value, 0.6, 4.0 * t.joint.lever_forward.sigma);
  EXPECT_NEAR(t.pitch.mean, f.truth.pitch.value, 4.0 * t.pitch.sigma);
  // The same with the right lever arm: nothing is said of one.
  in_force.lever_arm_scanner[0] = core::Metres(0.6);
  t = analyse(f, in_force);
  EXPECT_FALSE(t.pitch.of_two_heights);
  EXPECT_TRUE(says(t, "shows no error of the lever arm")) << all_of(t);
  EXPECT_NEAR(t.pitch.mean, f.truth.pitch.value, 4.0 * t.pitch.sigma);
}

TEST(FlatTarget, AWrongScanScaleIsNoticed) {
  BoxFlight f;
  f.lines = full_pattern(0.42);
  f.truth.scan_scale = 1.002;
  const FlatTarget t = analyse(f, {});
  EXPECT_TRUE(says(t, "too narrow across the flight")) << all_of(t);
  EXPECT_NEAR(t.scan_scale, 1.002, 5.0 * t.scan_scale_sigma + 5e-5);
}

TEST(FlatTarget, ADatumOffsetIsNamedAndCancels) {
  BoxFlight f;
  f.lines = full_pattern(0.42);
  f.datum = {0.3, -0.2, 0.0};
  const FlatTarget t = analyse(f, {});
  EXPECT_TRUE(says(t, "in all lines alike: datum or base station")) << all_of(t);
  EXPECT_NEAR(t.joint.datum.x(), 0.3, 0.03);
  EXPECT_NEAR(t.joint.datum.y(), -0.2, 0.03);
  EXPECT_NEAR(t.pitch.mean, 0.0, 4.0 * arc_second);
  EXPECT_NEAR(t.heading.mean, 0.0, 15.0 * arc_second);
}

TEST(FlatTarget, TargetsByName) {
  BoxFlight f;
  f.lines = {{1, 0.42, 0.0, 700.0}, {2, 0.42 + core::pi, 0.0, 700.0}};
  FlatTargetOptions o;
  o.target = "hall";
  EXPECT_TRUE(analyse(f, {}, o).done);
  o.target = "shed";
  try {
    analyse(f, {}, o);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("the targets are hall"), std::string::npos) << e.text();
  }
}

TEST(FlatTarget, ASurveyedRoofThatCannotBeUsedIsTold) {
  BoxFlight f;
  f.lines = {{1, 0.42, 0.0, 700.0}, {2, 0.42 + core::pi, 0.0, 700.0}};
  BoxRecords r = fly(f);
  std::swap(r.control[1], r.control[2]);  // across the roof and back
  const core::Scanner scanner;
  const trajectory::Trajectory trajectory(r.delivered);
  core::Tally tally;
  const FlatTarget t = analyse_flat_target(r.stream(), scanner, {}, r.sigma, trajectory, r.covariance, r.control, {}, tally);
  EXPECT_TRUE(says(t, "the corners of target 'hall' do not go around a convex roof; it takes no part")) << all_of(t);
  EXPECT_FALSE(t.target.surveyed);
}

}  // namespace
}  // namespace swath::calib
