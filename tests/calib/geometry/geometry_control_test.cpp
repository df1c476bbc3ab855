// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_control.h"

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

TEST(GeometryControl, EllipsoidalHeightsOfControlOverAGeoidAreNotTheTrajectorys) {
  ControlFigures c;
  c.compared = 12, c.spread = 0.05, c.control = 600.0, c.ground = 553.4, c.median = -46.6;
  const auto stated = height_mistake(c, 46.6, 600.0, true), other = height_mistake(c, 46.6, 600.0, false);
  ASSERT_TRUE(stated && other);
  EXPECT_EQ(stated->name, "height_geoid");
  EXPECT_NE(stated->what.find("the control's heights ellipsoidal, or"), std::string::npos) << stated->what;
  EXPECT_NE(stated->cure.find("state its crs with +ellipsoidal"), std::string::npos) << stated->cure;
  EXPECT_NE(other->what.find("the trajectory's heights"), std::string::npos) << other->what;
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

TEST(GeometryControl, OneWrongPointNamesNothing) {
  const GateFlight& f = flight();
  const trajectory::Trajectory t(f.data);
  GeometryInput in = f.input(t);
  in.control.push_back({GateFlight::local().to_ecef({35, 15, GateFlight::ground(35, 15, false) + 0.8}), 0.02});
  const GeometryFigures g = judge_geometry(in, {});
  EXPECT_EQ(g.control.compared, 1u);
  EXPECT_EQ(g.verdict, Verdict::consistent);
  EXPECT_TRUE(g.named.empty());
}

TEST(GeometryControl, RangesOfASingleLineInFeetAreNamed) {
  GateFlight f(false, 1);
  for (double& r : f.shots[0].range) r /= 0.3048;
  const trajectory::Trajectory t(f.data);
  GeometryInput in = f.input(t);
  for (const double x : {-70.0, -30.0, 0.0, 35.0, 70.0})
    for (const double y : {-85.0, -55.0, -5.0})
      in.control.push_back({GateFlight::local().to_ecef({x, y, GateFlight::ground(x, y, false)}), 0.02});
  const GeometryFigures g = judge_geometry(in, {});
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "range_feet");
}

TEST(GeometryControl, ATrajectoryInFeetIsToldByItsHeightNotTheGrounds) {
  constexpr double ground = 450, range = 900, foot = 0.3048;
  ControlFigures c;
  c.compared = 5, c.spread = 0.1, c.control = ground, c.ground = (ground + range) / foot - range;
  c.median = c.ground - c.control;
  const auto found = height_mistake(c, std::nan(""), range);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->name, "trajectory_height_feet");
  c.spread = 40;
  EXPECT_FALSE(height_mistake(c, std::nan(""), range));
}

TEST(GeometryControl, AKnownGeoidIsAskedBeforeFeet) {
  ControlFigures c;
  c.compared = 5, c.spread = 0.1, c.control = 67.6, c.ground = 20.6;  // nearly a ratio of feet
  c.median = c.ground - c.control;
  EXPECT_EQ(height_mistake(c, 47.0, 300)->name, "height_geoid");
  EXPECT_EQ(height_mistake(c, std::nan(""), 300)->name, "control_feet");
}

TEST(GeometryControl, TheHeightOnASlopeFollowsEachValueAsItsDerivativeSays) {
  const GateFlight& f = flight();
  const trajectory::Trajectory t(f.data);
  const trajectory::LocalFrame frame = GateFlight::local();
  const core::Shots& shots = f.shots[0];
  GroundCell cell;
  cell.sample = static_cast<std::uint32_t>(shots.size() / 2 + 77);
  cell.n = 10, cell.slope = {0.4, -0.6};
  const auto place_of = [&](const core::Calibration& c) {
    const ShotGeometry geometry(f.chain.scanner, c);
    trajectory::Cursor cursor(t);
    const double time = geometry.time(shots.time[cell.sample]);
    EXPECT_TRUE(cursor.seek(time));
    Jacobian J;
    const Eigen::Vector3d p = geometry.ecef_point(cursor.pose(time), {shots.angle[cell.sample], 0.0, shots.range[cell.sample]}, J);
    return Eigen::Vector3d(frame.local_R_ecef * (p - frame.origin));
  };
  cell.mean = place_of(f.chain.calibration);
  const Eigen::Vector2d at = cell.mean.head<2>() + Eigen::Vector2d(0.7, -0.4);
  const auto height = [&](const core::Calibration& c) {
    const Eigen::Vector3d p = place_of(c);
    return p.z() + cell.slope.dot(at - p.head<2>());
  };
  trajectory::Cursor cursor(t);
  const auto look = look_at(cell, shots, height_direction(cell), ShotGeometry(f.chain.scanner, f.chain.calibration), cursor, frame);
  ASSERT_TRUE(look);
  const auto check = [&](Parameter k, double step, auto value) {
    core::Calibration more = f.chain.calibration, less = more;
    value(more) += step, value(less) -= step;
    EXPECT_NEAR((height(more) - height(less)) / (2 * step), look->by[k], 1e-3 * (1 + std::abs(look->by[k]))) << k;
  };
  check(boresight_roll, 1e-5, [](core::Calibration& c) -> double& { return c.roll.value; });
  check(boresight_pitch, 1e-5, [](core::Calibration& c) -> double& { return c.pitch.value; });
  check(lever_forward, 1e-3, [](core::Calibration& c) -> double& { return c.lever_arm_scanner[0].value; });
  check(range_offset, 1e-3, [](core::Calibration& c) -> double& { return c.range_offset.value; });
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
