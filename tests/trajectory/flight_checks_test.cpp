// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/flight_checks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"
#include "core/geo/frames.h"

namespace swath::trajectory {
namespace {

constexpr double deg = core::degree;

/// A race track with wind: legs of 60 s, turns of 3 deg/s, an airspeed of 50 m/s, climbs of 1 m/s to and fro.
core::TrajectoryData race_track(double turns = 4) {
  core::TrajectoryData d;
  double north = 0, east = 0, height = 500, heading = 0.3;
  constexpr double dt = 0.05, airspeed = 50, wind_north = -6, wind_east = 3;
  for (int i = 0; i < static_cast<int>(turns * 120 / dt); ++i) {
    const double t = i * dt, phase = std::fmod(t, 120.0);
    const double rate = phase < 60 ? 0.0 : 3 * deg * (phase < 90 ? 1.0 : 0.6);
    heading += rate * dt;
    const double vn = airspeed * std::cos(heading) + wind_north, ve = airspeed * std::sin(heading) + wind_east, vd = -std::sin(0.05 * t);
    north += vn * dt, east += ve * dt, height -= vd * dt;
    d.time.push_back(t);
    d.latitude.push_back(47.9 * deg + north / 6.37e6);
    d.longitude.push_back(10.5 * deg + east / (6.39e6 * std::cos(47.9 * deg)));
    d.height.push_back(height);
    d.roll.push_back(std::atan(airspeed * rate / 9.81));
    d.pitch.push_back(2 * deg);
    d.heading.push_back(core::wrap_two_pi(heading));
    d.v_north.push_back(vn), d.v_east.push_back(ve), d.v_down.push_back(vd);
  }
  return d;
}

TEST(FlightChecks, ARightFlightHasNoBias) {
  const FlightChecks c = check_flight(race_track());
  ASSERT_TRUE(c.heading && c.roll_turns && c.pitch_turns && c.climb);
  EXPECT_NEAR(c.heading->bias, 0.0, 1 * deg);
  EXPECT_NEAR(c.heading->airspeed, 50.0, 1.0);
  EXPECT_NEAR(c.heading->wind, std::hypot(6.0, 3.0), 1.0);
  EXPECT_LT(c.heading->misfit, 0.05);
  EXPECT_NEAR(c.roll_turns->factor, 1.0, 0.2);
  EXPECT_NEAR(c.pitch_turns->factor, 0.0, 0.2);
  EXPECT_NEAR(c.climb->factor, 1.0, 0.02);
}

TEST(FlightChecks, EachMistakeShowsInItsOwnFigure) {
  core::TrajectoryData d = race_track();
  for (double& h : d.heading) h += 7 * deg;
  EXPECT_NEAR(check_flight(d).heading->bias, 7 * deg, 1 * deg);
  d = race_track();
  for (double& h : d.heading) h = -h;
  EXPECT_GT(check_flight(d).heading->misfit, 0.3);
  d = race_track();
  for (double& r : d.roll) r = -r;
  EXPECT_NEAR(check_flight(d).roll_turns->factor, -1.0, 0.2);
  d = race_track();
  std::swap(d.roll, d.pitch);
  EXPECT_NEAR(check_flight(d).pitch_turns->factor, 1.0, 0.2);
  d = race_track();
  for (double& h : d.height) h /= 0.3048;
  EXPECT_NEAR(check_flight(d).climb->factor, 1 / 0.3048, 0.1);
}

TEST(FlightChecks, AGapIsNotManySamples) {
  // A day between two flights; the first records after it differ from the rest.
  core::TrajectoryData d = race_track(), later = race_track();
  const size_t turns = check_flight(d).climb->samples;
  for (size_t i = 0; i < later.size(); ++i) {
    using D = core::TrajectoryData;
    d.time.push_back(later.time[i] + 86400);
    for (const auto c : {&D::latitude, &D::longitude, &D::height, &D::roll, &D::pitch, &D::heading, &D::v_north, &D::v_east, &D::v_down})
      (d.*c).push_back((later.*c)[i]);
  }
  const FlightChecks c = check_flight(d);
  EXPECT_NEAR(static_cast<double>(c.climb->samples), 2.0 * static_cast<double>(turns), 4.0);
  EXPECT_NEAR(c.heading->bias, 0.0, 1 * deg);
}

TEST(FlightChecks, AFixedHeadingDeterminesNoBias) {
  core::TrajectoryData d = race_track();
  for (double& h : d.heading) h = 0.7;
  EXPECT_FALSE(check_flight(d).heading);
}

TEST(FlightChecks, AStraightFlightDeterminesNeither) {
  const FlightChecks c = check_flight(race_track(0.45));
  EXPECT_FALSE(c.heading);
  EXPECT_FALSE(c.roll_turns);
}

}  // namespace
}  // namespace swath::trajectory
