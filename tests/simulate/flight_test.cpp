// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/units.h"

namespace swath::simulate {
namespace {

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

Flight flight(double turbulence = 1.0) {
  FlightOptions o;
  o.turbulence = turbulence;
  return Flight(o, origin, 950.0, plan_lines(o, {}, core::degrees(20).value, 0.02), 5.2, 1);
}

TEST(Flight, DerivativesAreThoseOfThePose) {
  const Flight f = flight();
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
  }
}

TEST(Flight, HasNoJumpsAndBanksInTurnsOnly) {
  const Flight f = flight(0.0);
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

TEST(Flight, FliesItsLines) {
  const Flight f = flight(0.0);
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

TEST(Flight, LinesOverlapAsAsked) {
  FlightOptions o;
  o.height = core::Metres(500);
  o.overlap = 0.25;
  o.lines = 4;
  o.cross_lines = 2;
  const auto plan = plan_lines(o, {}, 0.3, 0.0);
  ASSERT_EQ(plan.size(), 6u);
  const double swath = 2 * 500 * std::tan(0.3);
  const Eigen::Vector2d a = 0.5 * (plan[0].from + plan[0].to), b = 0.5 * (plan[1].from + plan[1].to);
  EXPECT_NEAR((a - b).norm(), 0.75 * swath, 1e-9);
  EXPECT_NEAR((plan[0].to - plan[0].from).normalized().dot((plan[4].to - plan[4].from).normalized()), 0.0, 1e-12);
  EXPECT_NEAR((plan[0].to - plan[0].from).normalized().dot((plan[1].to - plan[1].from).normalized()), -1.0, 1e-12);
}

}  // namespace
}  // namespace swath::simulate
