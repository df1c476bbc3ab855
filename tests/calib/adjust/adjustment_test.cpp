// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjustment.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

// Roll and pitch estimated and correlated, a lever arm held that moves the pitch.
Adjustment made() {
  Adjustment a;
  constexpr int n = latency + 1;
  a.formal = a.held = Eigen::MatrixXd::Zero(n, n);
  a.held_correlation = Eigen::MatrixXd::Identity(n, n);
  a.formal(boresight_roll, boresight_roll) = 4.0;
  a.formal(boresight_pitch, boresight_pitch) = 9.0;
  a.formal(boresight_roll, boresight_pitch) = a.formal(boresight_pitch, boresight_roll) = 3.0;
  a.held(lever_forward, lever_forward) = 0.5;
  a.held(boresight_pitch, lever_forward) = 4.0;
  for (const Parameter p : {boresight_roll, boresight_pitch}) {
    Estimate& e = a.estimates[p];
    e.parameter = p;
    e.estimated = e.delivered = true;
    e.apriori = 10.0;
    e.start = 1.0;
    e.value = e.found = 2.0;
    e.formal = std::sqrt(a.formal(p, p));
    e.held = p == boresight_pitch ? 4.0 : 0.0;
    e.sigma = e.found_sigma = std::hypot(e.formal, e.held);
    a.calibration.roll = a.calibration.pitch = core::Radians(2.0);
  }
  return a;
}

TEST(Adjustment, CovarianceOfWhatIsDelivered) {
  const Eigen::MatrixXd C = delivered_covariance(made());
  EXPECT_DOUBLE_EQ(C(boresight_roll, boresight_roll), 4.0);
  EXPECT_DOUBLE_EQ(C(boresight_pitch, boresight_pitch), 25.0);
  EXPECT_DOUBLE_EQ(C(boresight_roll, boresight_pitch), 3.0);
  EXPECT_DOUBLE_EQ(C(boresight_pitch, lever_forward), 4.0 * 0.5);
  EXPECT_DOUBLE_EQ(C(lever_forward, lever_forward), 0.25);
  EXPECT_EQ(C(lever_right, lever_right), 0.0);
  EXPECT_EQ(delivered_covariance({}).size(), 0);
}

TEST(Adjustment, AnEnlargedSigmaEnlargesTheRow) {
  Adjustment a = made();
  a.estimates[boresight_roll].found_sigma *= 1.5;
  const Eigen::MatrixXd C = delivered_covariance(a);
  EXPECT_DOUBLE_EQ(C(boresight_roll, boresight_roll), 9.0);
  EXPECT_DOUBLE_EQ(C(boresight_roll, boresight_pitch), 4.5);
}

TEST(Adjustment, AWithdrawnValueIsAsItStarted) {
  Adjustment a = made();
  withdraw(a, {boresight_pitch, latency}, Grade::undetermined);
  const Estimate& e = a.estimates[boresight_pitch];
  EXPECT_FALSE(e.delivered);
  EXPECT_EQ(e.grade, Grade::undetermined);
  EXPECT_EQ(e.value, 1.0);
  EXPECT_EQ(e.found, 2.0);
  EXPECT_EQ(e.sigma, 10.0);
  EXPECT_EQ(e.found_sigma, 5.0);
  EXPECT_EQ(a.calibration.pitch.value, 1.0);
  EXPECT_EQ(a.calibration.roll.value, 2.0);
  EXPECT_EQ(a.estimates[latency].grade, Grade::held);
  // The start's error goes into the roll as the common solution says: Cov(e, e0) = P.
  const Eigen::MatrixXd C = delivered_covariance(a);
  EXPECT_DOUBLE_EQ(C(boresight_pitch, boresight_pitch), 100.0);
  EXPECT_DOUBLE_EQ(C(boresight_roll, boresight_pitch), 3.0);
  EXPECT_EQ(C(boresight_pitch, lever_forward), 0.0);
}

}  // namespace
}  // namespace swath::calib
