// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/small_errors.h"

#include <gtest/gtest.h>

#include "calib/geometry/geometry_trial.h"
#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;
constexpr double deg = core::degree;

const GateFlight& flight() {
  static const GateFlight f;
  return f;
}

/// What the lines of a flight with another calibration say.
SmallErrors errors_of(const core::Calibration& stated) {
  GateFlight f = flight();
  f.chain.calibration = stated;
  const trajectory::Trajectory t(f.data);
  const GeometryInput in = f.input(t);
  const SampledFlight s = std::move(sampled(in, {}, GateFlight::local(), {{0.0, in.range}}).front());
  const LineCells cells = line_cells(s, f.chain, t);
  return small_errors({s.sample, cells.ground, cells.pairs, cells.control, ShotGeometry(f.chain.scanner, stated), f.sensor, t, s.frame});
}

TEST(SmallErrors, ARightCalibrationGainsNothing) {
  const SmallErrors e = errors_of(flight().chain.calibration);
  EXPECT_GT(e.differences, 200u);
  const double now = e.with(SmallVector::Zero()).squares;
  EXPECT_LT(now - e.with(SmallVector::Zero(), {boresight_roll, boresight_pitch, boresight_heading}).squares, 12);
  EXPECT_LT(now - e.with(SmallVector::Zero(), {lever_forward, lever_right}).squares, 9);
}

TEST(SmallErrors, TheBoresightsErrorIsFoundWithinItsSigmas) {
  core::Calibration c = flight().chain.calibration;
  c.roll.value += 0.06 * deg, c.pitch.value -= 0.05 * deg;
  const SmallErrors e = errors_of(c);
  const auto s = e.with(SmallVector::Zero(), {boresight_roll, boresight_pitch, boresight_heading});
  EXPECT_NEAR(s.error[boresight_roll] / deg, 0.06, 5 * s.sigma[boresight_roll] / deg);
  EXPECT_NEAR(s.error[boresight_pitch] / deg, -0.05, 5 * s.sigma[boresight_pitch] / deg);
  EXPECT_LT(s.sigma[boresight_roll] / deg, 0.012);
}

TEST(SmallErrors, AKnownErrorFitsAsWellAsAFoundOne) {
  core::Calibration c = flight().chain.calibration;
  c.lever_arm_scanner[0].value += 0.4;
  const SmallErrors e = errors_of(c);
  SmallVector known = SmallVector::Zero();
  known[lever_forward] = 0.4;
  const double now = e.with(SmallVector::Zero()).squares, right = e.with(known).squares;
  EXPECT_GT(now - right, 30);
  EXPECT_NEAR(right, e.with(SmallVector::Zero(), {lever_forward, lever_right}).squares, 6);
}

}  // namespace
}  // namespace swath::calib
