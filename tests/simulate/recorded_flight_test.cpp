// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/recorded_flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "io/records/trajectory_file.h"
#include "simulate/files/trajectory_files.h"
#include "simulate/planned_flight.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

/// Stated velocity, acceleration and rates against differences of poses and velocities.
void expect_derivatives(const Flight& f) {
  constexpr double h = 1e-3;
  for (double t = 0.5; t < f.duration() - 0.5; t += 0.37) {
    const Motion m = f.motion(t), before = f.motion(t - h), after = f.motion(t + h);
    const Vector3d step = core::ecef_of(after.pose.position) - core::ecef_of(before.pose.position);
    const Vector3d v = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude).transpose() * step / (2 * h);
    // h^2 / 6 of third derivatives: jerks of a real aircraft reach some 20 m/s^3, those of its rates 5 rad/s^3 per second.
    EXPECT_LT((v - m.velocity).norm(), 2e-5) << t;
    EXPECT_LT(((after.velocity - before.velocity) / (2 * h) - m.acceleration).norm(), 5e-4) << t;
    const Vector3d turn(after.pose.attitude.roll - before.pose.attitude.roll, after.pose.attitude.pitch - before.pose.attitude.pitch,
                        core::wrap_pi(after.pose.attitude.heading - before.pose.attitude.heading));
    EXPECT_LT((turn / (2 * h) - m.attitude_rate).norm(), 2e-5) << t;
  }
}

TEST(RecordedFlight, FollowsAFlightThroughNorth) {
  FlightOptions o;
  o.direction = core::degrees(350.0);
  const PlannedFlight flown(o, origin, 950.0, plan_lines(o, {}, 0.35, 0.0), 5.2, 1);
  const core::TrajectoryData records = true_trajectory(flown, core::from_week(2317, 1000.0));
  const RecordedFlight f(records, 0.1);
  EXPECT_EQ(f.duration(), flown.duration());
  EXPECT_EQ(f.lines().size(), 1u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_LT(f.departure().worst[i], 1e-3);                // m
    EXPECT_LT(f.departure().worst[3 + i], 0.5 / 206265.0);  // half an arc second
    EXPECT_GT(f.departure().rms[i], 0.0);
  }
  for (double t = 0.0; t <= f.duration(); t += 0.73) {
    const Motion a = f.motion(t), b = flown.motion(t);
    EXPECT_LT((core::ecef_of(a.pose.position) - core::ecef_of(b.pose.position)).norm(), 1e-3) << t;
    EXPECT_LT((a.velocity - b.velocity).norm(), 0.02) << t;
  }
  expect_derivatives(f);
}

TEST(RecordedFlight, RefusesWhatIsTooShort) {
  FlightOptions o;
  const PlannedFlight flown(o, origin, 950.0, plan_lines(o, {}, 0.35, 0.0), 5.2, 1);
  core::TrajectoryData records = true_trajectory(flown, 0.0);
  records.time.resize(300);
  EXPECT_THROW(RecordedFlight(records, 0.1), core::Error);
}

TEST(RecordedFlight, FollowsARealTrajectory) {
  SWATH_SHARED_OR_SKIP(file, "data/sbet_houston/sbet_047_IGS08-UTM15N-Ellipsoid-trim.txt");
  io::TrajectoryFile t;
  t.file = file;
  t.crs = "EPSG:32615";
  t.angle_unit = io::AngleUnit::deg;
  t.time.scale = core::TimeScale::gps_week;
  t.time.week = 1700;
  t.columns = {"GpsTime", "", "Y", "X", "Z", "Roll", "Pitch", "Azimuth", "", "", "", "", "", "", "", "", ""};
  core::Tally tally;
  const core::TrajectoryData records = io::read_trajectory(io::Survey{}, t, tally);
  const RecordedFlight f(records, 0.1);
  EXPECT_EQ(f.duration(), 72.0);
  for (size_t i = 0; i < 3; ++i) EXPECT_LT(f.departure().rms[i], 1e-3) << i;                  // 1 mm
  for (size_t i = 3; i < 6; ++i) EXPECT_LT(f.departure().rms[i], 0.004 * core::degree) << i;  // its vibration above 5 Hz
  expect_derivatives(f);
}

}  // namespace
}  // namespace swath::simulate
