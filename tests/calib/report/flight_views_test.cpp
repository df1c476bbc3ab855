// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flight_views.h"

#include <gtest/gtest.h>

#include "core/geo/geodesy.h"
#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

namespace made = test;

TEST(FlightViews, DifferencesSectionsAndChecksBeforeAndAfter) {
  made::TieWorld world;
  world.houses = {made::gable({0, 0}, 0.4, 14, 8, 0.0, 5, 9)};
  world.range_noise = 0.01;
  world.prf = 40000;
  world.truth.roll = core::degrees(0.1);
  const made::Flown flown = made::fly(world, {{{0, 0}, 400, 0.3, 200}, {{0, 0}, 400, 0.3 + core::pi, 200}}, 1);
  const trajectory::Trajectory trajectory(flown.data);
  const core::Crs crs("EPSG:32632");
  core::Transform to_map(core::wgs84_ecef(), crs);

  CalibrationReport report;
  TieSet& ties = report.ties;
  ties.frame = world.frame;
  TiePlane roof;
  roof.centre = {1.5, 4, 7};
  const Eigen::Vector2d down(-std::sin(0.4), std::cos(0.4));
  roof.normal = Eigen::Vector3d(0.5 * down.x(), 0.5 * down.y(), 1).normalized();
  roof.half = {12, 4};
  roof.kind = TieKind::roof;
  ties.planes = {roof};
  ties.groups = {{0, 0, 0, 0}, {0, 1, 0, 0}};
  SurveyedTarget point;
  point.name = "peg";
  point.is_point = true;
  point.centre = {40, 10, -0.03};
  point.control = {{point.centre, 0.01, "peg"}};
  point.use = io::ControlUse::check;
  SurveyedTarget used = point;
  used.use = io::ControlUse::control;

  CalibrationFlight flight;
  flight.shots = [&](const std::function<void(int, const core::Shots&)>& work) {
    for (const auto& [line, shots] : flown.lines) work(line, shots);
  };
  flight.trajectory = &trajectory;
  flight.targets = {point, used};
  const BeforeAndAfter rms =
      add_views(flight, {crs, 1.0, to_map(world.frame.origin).array().round().matrix()}, {world.truth, trajectory}, {}, 2.0, 3, report);
  ASSERT_EQ(report.differences.size(), 1u);
  // Roll 0.1 deg turns the two lines against one another by 0.2 deg: up to 0.5 m at 145 m from the nadir.
  EXPECT_GT(rms.before, 0.1);
  EXPECT_LT(rms.after, 0.02) << "means of some ten returns of 1 cm each";
  ASSERT_EQ(report.sections.size(), 1u);
  EXPECT_EQ(report.sections[0].after.size(), 2u) << "both lines";
  ASSERT_EQ(report.checks.size(), 1u) << "control is no check";
  EXPECT_NEAR(report.checks[0].residual, 0.03, 4 * 0.01 / std::sqrt(10));
}

}  // namespace
}  // namespace swath::calib
