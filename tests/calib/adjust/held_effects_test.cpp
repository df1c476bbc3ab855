// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/held_effects.h"

#include <gtest/gtest.h>

#include "calib/adjust/adjust.h"
#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

constexpr double arcsec = deg / 3600.0;

TEST(HeldEffects, CorrelationIsReadByName) {
  core::SensorSigma s;
  EXPECT_EQ(correlation_of(s, boresight_roll, boresight_pitch), 0.0);
  EXPECT_EQ(correlation_of(s, latency, latency), 1.0);
  s.correlation.assign(121, 0.0);
  s.correlation[boresight_roll * 11 + scan_scale] = -0.4;
  EXPECT_EQ(correlation_of(s, boresight_roll, scan_scale), -0.4);
}

// A strip adjustment with a calibration that is held and wrong: what it does to the corrections is in their sigmas, and their response
// says which way.
TEST(HeldEffects, TheCorrectionsHoldAWrongCalibration) {
  World w = make_world({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}}, block_planes(5, 10, 5));
  w.returns = 12;
  w.noise.pitch = w.noise.heading = core::Radians(0.0);
  w.noise.lever_arm = core::Metres(0.0);
  w.noise.roll = core::Radians(60.0 * arcsec);
  Dice dice(3);
  const TieSet ties = ties_of(w, &dice);
  const trajectory::Trajectory t(w.exact);
  AdjustOptions o;
  o.snooping.use = false;
  o.estimate = {false, false, false, false, false, false, false, false, false, false, false};
  o.corrections.spacing = core::Seconds(5.0);
  o.components = {false, false, false, false, false, false, core::Metres(0.003), 15.0};
  core::Calibration wrong = w.truth;
  wrong.roll.value += w.noise.roll.value;
  const Adjustment held = adjust(ties, w.scanner, wrong, w.noise, t, tactical_errors, o);
  const Adjustment exact = adjust(ties, w.scanner, w.truth, w.noise, t, tactical_errors, o);
  core::SensorSigma sure = w.noise;
  sure.roll = core::Radians(0.0);
  const Adjustment silent = adjust(ties, w.scanner, w.truth, sure, t, tactical_errors, o);
  ASSERT_FALSE(held.corrections.empty());
  double moved = 0.0;
  for (size_t l = 0; l < held.corrections.size(); ++l) {
    const LineCorrection &a = held.corrections[l], &b = exact.corrections[l], &c = silent.corrections[l];
    ASSERT_EQ(a.response.size(), a.value.size());
    for (size_t k = 0; k < a.value.size(); ++k) {
      const double roll = a.value[k][3] - b.value[k][3], told = w.noise.roll.value * b.response[k](3, boresight_roll);
      EXPECT_NEAR(roll, told, 0.1 * w.noise.roll.value);  // robust weights change with the misfit
      moved = std::max(moved, std::abs(roll));
      EXPECT_NEAR(b.sigma[k][3], std::hypot(c.sigma[k][3], told), 1e-3 * b.sigma[k][3]);
      EXPECT_TRUE(c.response[k].isZero(0.0));
    }
  }
  EXPECT_GT(moved, 10.0 * arcsec);
}

}  // namespace
}  // namespace swath::calib
