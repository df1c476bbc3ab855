// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/trajectory_files.h"

#include <gtest/gtest.h>

#include <cmath>

#include "io/records/sbet.h"
#include "io/records/trajectory_file.h"
#include "simulate/line_errors.h"
#include "simulate/planned_flight.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};
const core::GpsTime start = core::from_week(2317, 604790.25);  // passes into the next week

PlannedFlight flight() {
  FlightOptions o;
  o.lines = 2;
  o.cross_lines = 0;
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, 0.35, 0.0), 5.2, 1);
}

TEST(TrajectoryFiles, TruthReadBackIsTheFlightAt200Hz) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  io::write_sbet(folder / "sbet.out", true_trajectory(f, start));
  core::Tally tally;
  io::TimeTags tags;
  tags.scale = core::TimeScale::gps_week;
  tags.week = 2317;
  const core::TrajectoryData d = io::read_sbet(folder / "sbet.out", tags, true, io::VelocityAxes::automatic, std::nullopt, tally);
  EXPECT_TRUE(d.has_velocity());
  ASSERT_EQ(d.size(), 1 + static_cast<size_t>(std::lround(f.duration() * 200)));
  EXPECT_EQ(d.time.front(), start);
  EXPECT_EQ(d.time.back(), start + f.duration());
  // A GPS time of today resolves 0.24 us: 12 um at 50 m/s, 0.05 urad at 0.2 rad/s.
  for (size_t i = 0; i < d.size(); i += 37) {
    const Motion m = f.motion(d.time[i] - start);
    EXPECT_LT((core::ecef_of({d.latitude[i], d.longitude[i], d.height[i]}) - core::ecef_of(m.pose.position)).norm(), 2e-5);
    EXPECT_LT((Eigen::Vector3d(d.v_north[i], d.v_east[i], d.v_down[i]) - m.velocity).norm(), 2e-6);
    EXPECT_LT(std::abs(d.roll[i] - m.pose.attitude.roll), 1e-7);
    EXPECT_LT(std::abs(core::wrap_pi(d.heading[i] - m.pose.attitude.heading)), 1e-7);
  }
}

TEST(TrajectoryFiles, DeliveredFilesReadBackByTheirDescription) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  Options o;
  for (const TrajectoryOutput form : {TrajectoryOutput::sbet, TrajectoryOutput::text}) {
    o.output.trajectory = form;
    o.output.time = core::TimeScale::utc_day;
    io::Survey survey;
    survey.folder = folder.path();
    survey.trajectory = {write_trajectory(folder.path(), f, start, o)};
    core::Tally tally;
    const core::TrajectoryData d = io::read_trajectory(survey, tally);
    EXPECT_TRUE(d.has_sigma());
    ASSERT_EQ(d.size(), 1 + static_cast<size_t>(std::lround(f.duration() * 200)));
    double largest = 0;
    for (size_t i = 0; i < d.size(); i += 37)
      largest = std::max(largest, std::abs(d.height[i] - f.pose(d.time[i] - start).position.height));
    EXPECT_GT(largest, 0.2 * o.noise.vertical.value);
    EXPECT_LT(largest, 5 * o.noise.vertical.value);
  }
}

TEST(TrajectoryFiles, DeliveredLinesCarryTheirOwnErrorsAndStateThem) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  Options o;
  // Nothing but the lines' errors.
  o.noise.horizontal = o.noise.vertical = core::Metres(0);
  o.noise.roll_pitch = o.noise.heading = core::Radians(0);
  o.noise.line_shift = core::Metres(0.08);
  o.noise.line_drift = core::Metres(0.05);
  o.noise.line_attitude = core::degrees(0.01);
  const LineErrors expected(o.noise, f.lines(), o.seed);
  io::Survey survey;
  survey.folder = folder.path();
  survey.trajectory = {write_trajectory(folder.path(), f, start, o)};
  core::Tally tally;
  const core::TrajectoryData d = io::read_trajectory(survey, tally);
  double largest = 0;
  for (size_t i = 0; i < d.size(); i += 37) {
    const double t = d.time[i] - start;
    const Motion m = f.motion(t);
    const LineErrors::At e = expected.at(t);
    // A GPS time of today resolves 0.24 us.
    EXPECT_NEAR((d.latitude[i] - m.pose.position.latitude) * (core::meridian_radius(d.latitude[i]) + d.height[i]), e.value[0], 2e-5);
    EXPECT_NEAR(d.height[i] - m.pose.position.height, e.value[2], 2e-5);
    EXPECT_NEAR(d.pitch[i] - m.pose.attitude.pitch, e.value[4], 1e-7);
    EXPECT_NEAR(d.v_north[i] - m.velocity.x(), e.rate[0], 1e-5);
    EXPECT_NEAR(d.v_down[i] - m.velocity.z(), -e.rate[2], 1e-5);
    EXPECT_NEAR(static_cast<double>(d.sigma_down[i]), e.sigma[2], 1e-7);
    EXPECT_NEAR(static_cast<double>(d.sigma_heading[i]), 0.01 * core::degree, 0.01 * core::degree);
    largest = std::max(largest, std::abs(e.value[2]));
  }
  EXPECT_GT(largest, 0.005);
}

}  // namespace
}  // namespace swath::simulate
