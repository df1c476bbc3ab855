// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/small_mistakes.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

constexpr FlownAt flown{400, 50};

/// What 1 mm of scatter in each value would say of a calibration that is off by `error`.
SmallErrors errors_of(const SmallVector& error) {
  SmallErrors e;
  SmallVector weight = SmallVector::Constant(1e6);
  for (const int angle : {boresight_roll, boresight_pitch, boresight_heading, scan_offset, scan_scale, range_scale}) weight[angle] = 1e9;
  e.normal = weight.asDiagonal();
  e.right = e.normal * error;
  e.squares = error.dot(e.normal * error);
  e.differences = 1000;
  e.prior = SmallMatrix::Identity() * 1e-8;
  return e;
}

Chain stated() {
  Chain c;
  c.calibration.pitch = core::degrees(0.2);
  c.calibration.lever_arm_scanner = {core::Metres(0.5), core::Metres(-0.3), core::Metres(0.2)};
  return c;
}

std::vector<SmallExplanation> explained(const SmallVector& error, bool heights = false) {
  return explain_small(errors_of(error), stated(), stated(), usual_mistakes(stated(), 0.0, {-0.4, 0.1, -1.2}), flown, heights);
}

TEST(SmallMistakes, NothingIsSaidOfARightCalibration) { EXPECT_TRUE(explained(SmallVector::Zero()).empty()); }

TEST(SmallMistakes, AReversedSignIsPreferredToAFittedValue) {
  SmallVector error = SmallVector::Zero();
  error[lever_forward] = 1.0;  // stated 0.5, right -0.5
  const auto found = explained(error);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().name, "lever_arm_sign");
  EXPECT_TRUE(found.front().usual);
  EXPECT_NEAR(found.front().chain.calibration.lever_arm_scanner[0].value, -0.5, 1e-9);
}

TEST(SmallMistakes, AnErrorOfNoUsualKindIsFitted) {
  SmallVector error = SmallVector::Zero();
  error[lever_forward] = -0.3, error[lever_right] = 0.2;
  const auto found = explained(error);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().name, "lever_arm");
  EXPECT_NE(found.front().what.find("forward 0.80 m, right -0.50 m"), std::string::npos) << found.front().what;
}

TEST(SmallMistakes, ATrajectoryOfTheAntennaIsNamed) {
  SmallVector error = SmallVector::Zero();
  error.segment<3>(lever_forward) << -0.4, 0.1, -1.2;
  const auto found = explained(error, true);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().name, "trajectory_antenna");
}

TEST(SmallMistakes, ALeverArmThatIsLeftOutIsNamed) {
  Chain none;
  SmallVector error = SmallVector::Zero();
  error.segment<3>(lever_forward) << -0.4, 0.2, -0.3;
  const auto found = explain_small(errors_of(error), none, none, usual_mistakes(none, 0.0), flown, true);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().name, "lever_arm_missing");
}

TEST(SmallMistakes, ADifferenceOfHeightsStandsBesideSignsThatMatchIt) {
  SmallVector error = SmallVector::Zero();
  error[lever_down] = 0.4;  // stated 0.2: reversed it would be as good
  const auto found = explain_small(errors_of(error), stated(), stated(), usual_mistakes(stated(), 0.0), flown, true, true);
  ASSERT_GE(found.size(), 2u);
  EXPECT_EQ(found[0].name, "lever_arm_sign");
  EXPECT_EQ(found[1].name, "height_offset");
}

TEST(SmallMistakes, WhatIsFarTooLargeIsNotSaid) {
  SmallVector error = SmallVector::Zero();
  error[range_scale] = 2;
  EXPECT_TRUE(explained(error, true).empty());
}

TEST(SmallMistakes, MillimetresAreNotSaid) {
  SmallVector error = SmallVector::Zero();
  error[lever_forward] = 0.06;
  EXPECT_TRUE(explained(error).empty());
}

}  // namespace
}  // namespace swath::calib
