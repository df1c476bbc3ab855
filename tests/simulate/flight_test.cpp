// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

const core::Geodetic origin{-23.5 * core::degree, 179.999 * core::degree, 760.0};

/// A curved climb, faster than an aircraft's.
LocalPlane::State state_at(double t) {
  const double w = 0.3;
  LocalPlane::State s;
  s.position = {4000 * std::sin(w * t), 3000 * std::cos(w * t), 800 + 200 * std::sin(2 * w * t)};
  s.velocity = {4000 * w * std::cos(w * t), -3000 * w * std::sin(w * t), 400 * w * std::cos(2 * w * t)};
  s.acceleration = {-4000 * w * w * std::sin(w * t), -3000 * w * w * std::cos(w * t), -800 * w * w * std::sin(2 * w * t)};
  s.attitude = {0.1, -0.2, 7.0 + t};
  s.attitude_rate = {0.01, 0.02, 1.0};
  return s;
}

TEST(LocalPlane, MotionIsTheDerivativeOfThePlace) {
  const LocalPlane plane(origin, 760.0);
  constexpr double h = 1e-3;
  for (double t = 0; t < 20; t += 0.7) {
    const Motion before = plane.motion_of(state_at(t - h)), m = plane.motion_of(state_at(t)), after = plane.motion_of(state_at(t + h));
    const Vector3d step = core::ecef_of(after.pose.position) - core::ecef_of(before.pose.position);
    const Vector3d v = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude).transpose() * step / (2 * h);
    // Third derivatives of 100 m/s^3 times h^2 / 6, and the turning of north, east and down along the step.
    EXPECT_LT((v - m.velocity).norm(), 1e-4) << t;
    EXPECT_LT(((after.velocity - before.velocity) / (2 * h) - m.acceleration).norm(), 1e-4) << t;
    EXPECT_EQ(m.attitude_rate, state_at(t).attitude_rate);
    EXPECT_NEAR(m.pose.attitude.heading, core::wrap_two_pi(7.0 + t), 1e-12);
  }
}

TEST(LocalPlane, PlaceAndPlaneAreInverse) {
  const LocalPlane plane(origin, 760.0);
  for (const Vector3d& p : {Vector3d(0, 0, 760), Vector3d(-3000, 5000, 20), Vector3d(10, -20000, 3000)})
    EXPECT_LT((plane.plane_of(plane.geodetic_of(p)) - p).norm(), 2e-8);  // a longitude near 180 deg resolves 3 nm
  // Across the date line.
  EXPECT_NEAR(plane.plane_of({origin.latitude, -179.999 * core::degree, 760.0}).y(), 204.2, 0.5);
}

}  // namespace
}  // namespace swath::simulate
