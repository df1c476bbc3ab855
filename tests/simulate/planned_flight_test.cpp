// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/planned_flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::simulate {
namespace {

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

PlannedFlight flight(double turbulence = 1.0) {
  FlightOptions o;
  o.turbulence = turbulence;
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, core::degrees(20).value, 0.02), 5.2, 1);
}

PlannedFlight with_departure() {
  FlightOptions o;
  o.still = core::Seconds(40.0);
  o.lines = 1;
  o.cross_lines = 0;
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, core::degrees(20).value, 0.02), 5.2, 1);
}

/// A calibration flight at two heights: it climbs in circles, and sinks again to one more low line.
PlannedFlight with_climbs(double still = 0.0, double turbulence = 1.0) {
  FlightOptions o;
  o.pattern = FlightPattern::calibration;
  o.height = core::Metres(350.0);
  o.second_height = core::Metres(1150.0);
  o.edge_lines = o.profile_lines = false;
  o.still = core::Seconds(still);
  o.turbulence = turbulence;
  std::vector<LinePlan> plan = plan_lines(o, {}, core::degrees(20).value, 0.02);
  plan.push_back(plan.front());
  return PlannedFlight(o, origin, 950.0, plan, 5.2, 1);
}

void expect_derivatives(const PlannedFlight& f) {
  constexpr double h = 1e-3;
  for (double t = 1.0; t < f.duration() - 1; t += 1.37) {
    const Motion m = f.motion(t), before = f.motion(t - h), after = f.motion(t + h);
    // Central differences: third derivatives times h^2 / 6; positions carry 1e-9 m of rounding over 2 h.
    const Eigen::Vector3d step = core::ecef_of(after.pose.position) - core::ecef_of(before.pose.position);
    const Eigen::Vector3d v = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude).transpose() * step / (2 * h);
    EXPECT_LT((v - m.velocity).norm(), 1e-5) << t;
    EXPECT_LT(((after.velocity - before.velocity) / (2 * h) - m.acceleration).norm(), 1e-5) << t;
    const Eigen::Vector3d turn(after.pose.attitude.roll - before.pose.attitude.roll, after.pose.attitude.pitch - before.pose.attitude.pitch,
                               core::wrap_pi(after.pose.attitude.heading - before.pose.attitude.heading));
    EXPECT_LT((turn / (2 * h) - m.attitude_rate).norm(), 1e-5) << t;
    const Pose p = f.pose(t);
    EXPECT_LT((core::ecef_of(p.position) - core::ecef_of(m.pose.position)).norm(), 1e-8) << t;
    EXPECT_LT((core::matrix_of(p.attitude) - core::matrix_of(m.pose.attitude)).norm(), 1e-12) << t;
  }
}

TEST(PlannedFlight, DerivativesAreThoseOfThePose) {
  expect_derivatives(flight());
  expect_derivatives(with_departure());
  expect_derivatives(with_climbs());
  expect_derivatives(with_climbs(30.0));
}

TEST(PlannedFlight, ClimbsBetweenLinesOfDifferentHeightsOnly) {
  const PlannedFlight f = with_climbs(0.0, 0.0);
  ASSERT_EQ(f.lines().size(), 7u);  // along, across, along at both heights, along
  for (const Line& l : f.lines()) {
    const bool high = l.name.starts_with("high");
    for (double t = l.start - 4.9; t < l.end + 4.9; t += 1.0) {
      const Motion m = f.motion(t);
      EXPECT_NEAR(m.pose.position.height, high ? 1750.0 : 950.0, 1e-9) << l.name;
      EXPECT_EQ(m.velocity.z(), 0.0) << l.name;
    }
  }
  double steepest_up = 0, steepest_down = 0, hardest = 0;
  for (double t = 0; t < f.duration(); t += 0.05) {
    const Motion a = f.motion(t), b = f.motion(t + 1e-6);
    steepest_up = std::max(steepest_up, -a.velocity.z());
    steepest_down = std::max(steepest_down, a.velocity.z());
    hardest = std::max(hardest, std::abs(a.acceleration.z()));
    // Steady up to the second derivative: nothing jumps within a microsecond.
    EXPECT_LT((b.acceleration - a.acceleration).norm(), 1e-4) << t;
    EXPECT_LT((b.attitude_rate - a.attitude_rate).norm(), 1e-5) << t;
  }
  EXPECT_LT(steepest_up, 8.0 + 1e-9);  // the steepest climb allowed
  EXPECT_LT(steepest_down, 8.0 + 1e-9);
  EXPECT_GT(steepest_up, 4.0);
  EXPECT_GT(steepest_down, 4.0);
  EXPECT_LT(hardest, 0.5);
}

TEST(PlannedFlight, BeginsAtTheFirstLinesHeight) {
  FlightOptions o;
  std::vector<LinePlan> plan = plan_lines(o, {}, 0.3, 0.0);
  for (LinePlan& l : plan) l.level = 120.0;
  o.turbulence = 0.0;
  const PlannedFlight f(o, origin, 950.0, plan, 5.2, 1);
  for (double t = 0; t < f.duration(); t += 10.0) EXPECT_NEAR(f.pose(t).position.height, 1070.0, 1e-9);
}

TEST(PlannedFlight, BeginsAtRestOnTheGroundWhereAsked) {
  const PlannedFlight f = with_departure();
  const Motion rest = f.motion(0.0);
  for (const double t : {0.0, 20.0, 40.0}) {
    const Motion m = f.motion(t);
    EXPECT_EQ(m.velocity.norm(), 0.0);
    EXPECT_EQ(m.acceleration.norm(), 0.0);
    EXPECT_EQ(m.attitude_rate.norm(), 0.0);
    EXPECT_EQ(core::ecef_of(m.pose.position), core::ecef_of(rest.pose.position));
    EXPECT_NEAR(m.pose.position.height, 950.0 - FlightOptions{}.height.value + 2.0, 1e-9);
  }
  double strongest = 0, steepest = 0, turbulent = 0;
  for (double t = 40.0; t < f.lines()[0].start; t += 0.1) {
    const Motion m = f.motion(t);
    strongest = std::max(strongest, m.acceleration.norm());
    steepest = std::max(steepest, -m.velocity.z());
    if (m.pose.position.height < 603.0) turbulent = std::max(turbulent, std::abs(m.pose.attitude.roll));
  }
  EXPECT_GT(strongest, 2.5);  // the run's 3 m/s^2
  EXPECT_LT(strongest, 4.5);
  EXPECT_NEAR(steepest, 8.0, 1.0);                 // climb, and the turbulence
  EXPECT_LT(turbulent, core::degrees(0.3).value);  // none on the ground, little over it
  EXPECT_NEAR(f.motion(f.lines()[0].start).velocity.norm(), 50.0, 1.0);
  EXPECT_NEAR(f.pose(f.lines()[0].start).position.height, 950.0, 1.5);
}

TEST(PlannedFlight, EndsAtAWholeSecond) {
  const double d = flight().duration();
  EXPECT_EQ(d, std::round(d));
  EXPECT_GE(d, flight().lines().back().end + FlightOptions{}.lead.value - 1e-9);
}

TEST(PlannedFlight, SixLinesAndTheirTurnsLastTwelveMinutes) {
  FlightOptions o;
  o.lines = 6;
  o.cross_lines = 0;
  o.line_length = core::Metres(3500.0);
  o.lead = core::Seconds(10.0);
  o.height = core::Metres(1000.0);
  o.overlap = 0.0;
  o.bank = core::degrees(30.0);
  const PlannedFlight f(o, origin, 1600.0, plan_lines(o, {}, core::degrees(30).value, 0.02), 5.2, 1);
  EXPECT_EQ(f.lines().size(), 6u);
  EXPECT_NEAR(f.duration(), 720.0, 20.0);
}

TEST(PlannedFlight, HasNoJumpsAndBanksInTurnsOnly) {
  const PlannedFlight f = flight(0.0);
  double largest_bank = 0;
  for (double t = 0; t < f.duration() - 0.02; t += 0.02) {
    const Pose a = f.pose(t), b = f.pose(t + 0.02);
    ASSERT_NEAR((core::ecef_of(a.position) - core::ecef_of(b.position)).norm(), 1.0, 0.01);
    ASSERT_LT(std::abs(a.attitude.roll - b.attitude.roll), 0.005);
    largest_bank = std::max(largest_bank, std::abs(a.attitude.roll));
  }
  EXPECT_NEAR(largest_bank, core::degrees(22).value, 1e-6);
  for (const Line& l : f.lines())
    for (double t = l.start - 4; t < l.end + 4; t += 1) EXPECT_EQ(f.pose(t).attitude.roll, 0.0);
}

TEST(PlannedFlight, FliesItsLines) {
  const PlannedFlight f = flight(0.0);
  FlightOptions o;
  const std::vector<LinePlan> plan = plan_lines(o, {}, core::degrees(20).value, 0.02);
  ASSERT_EQ(f.lines().size(), 4u);
  const double north = core::meridian_radius(origin.latitude) + 950;
  const double east = (core::prime_vertical_radius(origin.latitude) + 950) * std::cos(origin.latitude);
  for (size_t i = 0; i < 4; ++i) {
    for (const auto& [t, p] : {std::pair{f.lines()[i].start, plan[i].from}, {f.lines()[i].end, plan[i].to}}) {
      const core::Geodetic g = f.pose(t).position;
      // The turns' legs are closed by bisection to 1 mm.
      EXPECT_NEAR((g.latitude - origin.latitude) * north, p.x(), 2e-3);
      EXPECT_NEAR((g.longitude - origin.longitude) * east, p.y(), 2e-3);
    }
    if (i > 0) {
      EXPECT_GT(f.lines()[i].start, f.lines()[i - 1].end + 10);
    }
  }
}

}  // namespace
}  // namespace swath::simulate
