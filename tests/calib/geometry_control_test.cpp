// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

const GateFlight& flight() {
  static const GateFlight f;
  return f;
}

/// Points on the true ground between the houses, `off` m too high.
GeometryFigures judged_with(double off, double undulation = std::nan(""), double east = 0.0,
                            const std::function<void(GateFlight&)>& change = {}) {
  GateFlight f = flight();
  if (change) change(f);
  const trajectory::Trajectory t(f.data);
  GeometryInput in = f.input(t);
  const trajectory::LocalFrame frame = GateFlight::local();
  for (const double x : {-70.0, -30.0, 0.0, 35.0, 70.0})
    for (const double y : {-5.0, 15.0}) in.control.push_back({frame.to_ecef({x + east, y, GateFlight::ground(x, y, false) + off}), 0.02});
  in.undulation = [undulation] { return undulation; };
  return judge_geometry(in, {});
}

TEST(GeometryControl, RightControlIsHeld) {
  const GeometryFigures g = judged_with(0);
  EXPECT_EQ(g.verdict, Verdict::consistent);
  EXPECT_GE(g.control.compared, 6u);
  EXPECT_NEAR(g.control.median, 0, 0.05);
  EXPECT_TRUE(g.warnings.empty());
}

TEST(GeometryControl, HeightsAboveTheGeoidAreNamed) {
  const GeometryFigures g = judged_with(-47);
  EXPECT_EQ(g.verdict, Verdict::inconsistent);
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "height_geoid");
  EXPECT_NE(g.warnings.front().find("above the control"), std::string::npos) << g.warnings.front();
}

TEST(GeometryControl, AKnownGeoidSaysWhoseHeights) {
  EXPECT_NE(judged_with(-47, 47.3).named.front().what.find("the control's heights"), std::string::npos);
  EXPECT_NE(judged_with(47, 47.3).named.front().what.find("the trajectory's heights"), std::string::npos);
  for (const TriedMistake& t : judged_with(-30, 47.3).named) EXPECT_NE(t.name, "height_geoid");
}

TEST(GeometryControl, HeightsInFeetAreNamed) {
  GeometryFigures g;
  GateFlight f = flight();
  const trajectory::Trajectory t(f.data);
  GeometryInput in = f.input(t);
  const trajectory::LocalFrame frame = GateFlight::local();
  for (const double x : {-70.0, -30.0, 0.0, 35.0, 70.0})
    in.control.push_back({frame.to_ecef({x, 15, GateFlight::ground(x, 15, false) + 600 * (1 / 0.3048 - 1)}), 0.02});
  g = judge_geometry(in, {});
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "control_feet");
}

TEST(GeometryControl, TheLeverArmsDownPartIsNamedByControl) {
  const GeometryFigures g = judged_with(0, std::nan(""), 0, [](GateFlight& f) { f.chain.calibration.lever_arm_scanner[2].value *= -1; });
  EXPECT_EQ(g.verdict, Verdict::inconsistent);
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "lever_arm_sign");
}

TEST(GeometryControl, ControlElsewhereIsNotCompared) {
  const GeometryFigures g = judged_with(0, std::nan(""), 30000);
  EXPECT_EQ(g.control.near, 0u);
  EXPECT_EQ(g.control.compared, 0u);
  EXPECT_NEAR(g.control.nearest, 30000, 500);
  EXPECT_EQ(g.verdict, Verdict::consistent);
}

}  // namespace
}  // namespace swath::calib
