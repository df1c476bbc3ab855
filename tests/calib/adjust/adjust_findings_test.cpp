// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust_findings.h"

#include <gtest/gtest.h>

#include "tests/calib/adjust_support.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::Vector3d;

TEST(AdjustFindings, DegenerateFlightsAreRefusedInWords) {
  const World one = pattern_of({{0.0, 0.0}});
  const Adjustment a = flown(one, plain(), 1, near_truth(one));
  EXPECT_TRUE(says(a, "one line only", true));
  for (const Parameter p : usual) {
    EXPECT_FALSE(a.estimates[p].delivered);
    EXPECT_EQ(a.estimates[p].value, a.estimates[p].start);
    EXPECT_EQ(a.estimates[p].sigma, a.estimates[p].apriori);
  }
  EXPECT_EQ(a.calibration.roll, near_truth(one).roll);

  const World one_way = pattern_of({{0.0, 0.0}, {0.0, 0.0}, {0.0, 50.0}});
  const Adjustment b = flown(one_way, plain(), 2, near_truth(one_way));
  EXPECT_TRUE(says(b, "boresight pitch and along-track shift cannot be separated: only one line direction", false));
  EXPECT_TRUE(b.estimates[boresight_pitch].delivered);
  EXPECT_EQ(b.estimates[boresight_pitch].grade, Grade::coarse);

  World level = pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}}, 0);
  for (TiePlane& p : level.planes) p.normal = Vector3d::UnitZ();
  const Adjustment c = flown(level, plain(), 3, near_truth(level));
  EXPECT_TRUE(says(c, "no sloping planes or walls", false));
  for (const Parameter p : {boresight_pitch, boresight_heading}) {
    EXPECT_EQ(c.estimates[p].grade, Grade::coarse);
    EXPECT_GT(c.estimates[p].sigma, 0.02 * deg);  // by the turns of the attitude alone
    EXPECT_LT(std::abs(c.estimates[p].value - value_of(level.truth, p)), 4.0 * c.estimates[p].sigma);
  }
  EXPECT_TRUE(c.estimates[boresight_roll].delivered);

  const World apart = pattern_of({{0.0, -900.0}, {0.0, 900.0}});
  const Adjustment d = flown(apart, plain(), 4, near_truth(apart));
  EXPECT_TRUE(says(d, "no plane is seen by two lines", true));
}

TEST(AdjustFindings, AStartThatTheFlightContradictsCountsForNothing) {
  const World w = pattern_of(full_pattern());
  AdjustOptions o = plain();
  // Stated to 18 arcsec, and 720 arcsec off.
  o.apriori.roll = o.apriori.pitch = core::degrees(0.005);
  core::Calibration start = w.truth;
  start.roll.value += 0.2 * deg;
  const Adjustment a = flown(w, o, 1, start);
  EXPECT_TRUE(says(a, "the start value of boresight roll is off by", false));
  EXPECT_FALSE(says(a, "the start value of boresight pitch is off by", false));
  EXPECT_TRUE(a.estimates[boresight_roll].delivered);
  EXPECT_TRUE(std::isinf(a.estimates[boresight_roll].apriori));
  EXPECT_LT(std::abs(a.estimates[boresight_roll].value - w.truth.roll.value), 4.0 * a.estimates[boresight_roll].sigma);
}

TEST(AdjustFindings, ValuesThatAreStillMovingAreNotDelivered) {
  const World w = pattern_of(full_pattern());
  AdjustOptions o = plain();
  o.iterations = 1;  // below what the option allows: one linearisation from far off
  o.snooping.use = false;
  o.corrections.position = o.corrections.attitude = CorrectionForm::none;
  core::Calibration start = w.truth;
  start.roll.value += 0.8 * deg;
  start.heading.value += 1.5 * deg;
  const Adjustment a = flown(w, o, 1, start);
  ASSERT_GT(a.last_step, settled_step);
  EXPECT_TRUE(says(a, "did not converge", true));
  for (const Parameter p : usual) {
    EXPECT_FALSE(a.estimates[p].delivered);
    EXPECT_EQ(a.estimates[p].grade, Grade::unsettled);
  }
}

// A survey of many lines has its knots spread to keep corrections.most: it must be said.
TEST(AdjustFindings, KnotsFartherApartThanAskedForAreNamed) {
  const World w = pattern_of(full_pattern());
  AdjustOptions o = plain();
  o.corrections.spacing = core::Seconds(2.0);
  const Adjustment asked = flown(w, o, 1, near_truth(w));
  EXPECT_LE(asked.knot_spacing, 2.0);
  EXPECT_FALSE(says(asked, "knots are", false));
  o.corrections.most = 100;
  const Adjustment wide = flown(w, o, 1, near_truth(w));
  EXPECT_GT(wide.knot_spacing, 3.0);
  EXPECT_TRUE(says(wide, "s apart in place of 2.0 s: all lines together have", false));
  EXPECT_TRUE(says(wide, "corrections.most allows 100;", false));
}

TEST(AdjustFindings, ControlInAnotherDatumIsNamed) {
  World w = pattern_of(full_pattern(), 12, 6);
  Dice dice(9);
  for (const size_t k : {size_t{3}, size_t{27}, size_t{30}, size_t{35}}) survey(w.planes[k], 0.02, &dice);
  for (TiePlane& p : w.planes)
    for (PlaneControl& c : p.control) c.point += Vector3d(3.0, 0.0, -2.0);
  const Adjustment a = flown(w, plain(), 6, near_truth(w));
  EXPECT_TRUE(says(a, "control does not fit: mean misfit east 3.0", false));
  for (const ControlResidual& c : a.control) EXPECT_TRUE(c.rejected);
}

}  // namespace
}  // namespace swath::calib
