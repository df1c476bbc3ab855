// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/agreement.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

TEST(CalibrationAgreement, TwoWaysAgreeWithinTwiceTheirJointSigma) {
  calib::Adjustment a = made_report().adjustment;
  calib::Estimate& e = a.estimates[calib::range_offset];
  e.value = 0.10;
  e.sigma = 0.03;
  const Agreement near = agreement_of(a, {calib::range_offset, 0.19, 0.04, 3, ""});
  EXPECT_TRUE(near.known && near.agrees);
  EXPECT_DOUBLE_EQ(near.difference, 0.09);
  EXPECT_DOUBLE_EQ(near.joint_sigma, 0.05);
  EXPECT_FALSE(agreement_of(a, {calib::range_offset, -0.01, 0.04, 3, ""}).agrees);
  EXPECT_FALSE(agreement_of(a, {calib::latency, 0.0, 1.0, 3, ""}).known);
}

TEST(CalibrationAgreement, AFlatTargetThatDisagreesIsNeverUnderAGreenBanner) {
  CalibrationReport r = made_report();
  r.adjustment.findings.clear();
  r.adjustment.control.clear();
  const calib::Estimate& roll = r.adjustment.estimates[calib::boresight_roll];
  r.readings = {{calib::boresight_roll, roll.value + 0.5 * roll.sigma, roll.sigma, 4, ""}};
  EXPECT_EQ(verdict_of(r).tone, report::Tone::good) << verdict_of(r).text;
  r.readings[0].value = roll.value + 6.0 * roll.sigma;
  const CalibrationVerdict v = verdict_of(r);
  EXPECT_EQ(v.tone, report::Tone::caution);
  EXPECT_TRUE(v.calibrated);
  EXPECT_TRUE(holds(v.text, "The flat target contradicts it: boresight roll by")) << v.text;
  EXPECT_TRUE(holds(v.text, "4.2 joint sigmas")) << v.text;
}

}  // namespace
}  // namespace swath::calib
