// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/start_sigmas.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

TEST(StartSigmas, TheSurveysSigmasAreTaken) {
  core::SensorSigma s;
  s.roll = core::degrees(0.3);
  s.scan_scale = 1e-4;
  s.range_offset = core::Metres(0.1);
  s.stated = {"roll", "scan_scale", "range_offset"};
  const AprioriOptions o = start_sigmas(s);
  EXPECT_EQ(o.roll.value, s.roll.value);
  EXPECT_EQ(o.scan_scale, 1e-4);
  EXPECT_EQ(apriori_of(o, range_offset), 0.1);
}

TEST(StartSigmas, WhatIsNotStatedOrZeroIsAnUncalibratedMountings) {
  core::SensorSigma s;  // its defaults are those of a calibrated scanner
  s.stated = {"heading", "scan_scale"};
  s.heading = core::Radians(0.0);
  const AprioriOptions o = start_sigmas(s), uncalibrated;
  for (int k = boresight_roll; k <= latency; ++k)
    EXPECT_EQ(apriori_of(o, static_cast<Parameter>(k)), apriori_of(uncalibrated, static_cast<Parameter>(k))) << k;
}

TEST(StartSigmas, ZeroCountsForNothing) {
  AprioriOptions o;
  o.pitch = core::Radians(0.0);
  EXPECT_TRUE(std::isinf(apriori_of(o, boresight_pitch)));
}

TEST(StartSigmas, AContradictionNeedsADepartureAndAFlightThatDetermines) {
  const Eigen::Vector4d apriori(1.0, 1.0, 1.0, std::numeric_limits<double>::infinity());
  const Eigen::Vector4d formal(0.1, 0.1, 0.9, 0.1), found(3.0, -5.0, 3.0, 50.0);
  const Eigen::VectorXd far = contradicted(found, formal, apriori);
  EXPECT_EQ(far[0], 0.0);                                   // three sigmas
  EXPECT_NEAR(far[1], 5.0 / std::sqrt(1.0 - 0.01), 1e-12);  // five
  EXPECT_EQ(far[2], 0.0);                                   // the flight knows less than the start
  EXPECT_EQ(far[3], 0.0);                                   // free already
}

}  // namespace
}  // namespace swath::calib
