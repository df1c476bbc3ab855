// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/inertial.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "simulate/planned_flight.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

PlannedFlight flight() {
  FlightOptions o;
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, core::degrees(20).value, 0.02), 5.2, 1);
}

Matrix3d inertial_R_ecef(double t) { return Eigen::AngleAxisd(core::wgs84::omega * t, Vector3d::UnitZ()).toRotationMatrix(); }
Vector3d inertial_position(const Flight& f, double t) { return inertial_R_ecef(t) * core::ecef_of(f.pose(t).position); }
Matrix3d inertial_R_body(const Flight& f, double t) {
  const Pose p = f.pose(t);
  return inertial_R_ecef(t) * core::ecef_R_ned(p.position.latitude, p.position.longitude) * core::matrix_of(p.attitude);
}

TEST(Inertial, IsTheMotionSeenFromInertialSpace) {
  const PlannedFlight f = flight();
  constexpr double h = 0.02;
  for (double t = 1.0; t < f.duration() - 1; t += 3.1) {
    const Inertial at = inertial_of(f.motion(t));
    const Matrix3d R = inertial_R_body(f, t);
    // Differences of 4th order; positions carry 1e-9 m, over h^2 2.5e-6 m/s^2.
    const Vector3d acceleration = (-inertial_position(f, t + 2 * h) + 16 * inertial_position(f, t + h) - 30 * inertial_position(f, t) +
                                   16 * inertial_position(f, t - h) - inertial_position(f, t - 2 * h)) /
                                  (12 * h * h);
    // Gravity (with the centrifugal part) back to gravitation.
    const Pose p = f.pose(t);
    const Vector3d ecef = core::ecef_of(p.position);
    const Vector3d down = core::ecef_R_ned(p.position.latitude, p.position.longitude).col(2);
    const Vector3d centrifugal = core::wgs84::omega * core::wgs84::omega * Vector3d(ecef.x(), ecef.y(), 0);
    const Vector3d gravitation = core::normal_gravity(p.position.latitude, p.position.height) * down - centrifugal;
    EXPECT_LT((R * at.force - (acceleration - inertial_R_ecef(t) * gravitation)).norm(), 3e-5) << t;
    const Eigen::AngleAxisd turn(inertial_R_body(f, t - h / 4).transpose() * inertial_R_body(f, t + h / 4));
    EXPECT_LT((turn.axis() * turn.angle() / (h / 2) - at.rate).norm(), 2e-5) << t;
  }
}

TEST(Inertial, IncrementsAreIntegrals) {
  constexpr double step = 0.005;
  const PlannedFlight f = flight();
  for (const double t : {3.0, 28.3, 77.0}) {
    Increments fine{Vector3d::Zero(), Vector3d::Zero()};
    for (int i = 1; i <= 10; ++i) {
      const Increments part = increments_of(f, t - step + i * step / 10, step / 10);
      fine.angle += part.angle;
      fine.velocity += part.velocity;
    }
    const Increments whole = increments_of(f, t, step);
    EXPECT_LT((whole.angle - fine.angle).norm(), 1e-12);
    EXPECT_LT((whole.velocity - fine.velocity).norm(), 1e-11);
  }
}

TEST(Inertial, VelocityOfAPointIsTheDerivativeOfItsPlace) {
  const PlannedFlight f = flight();
  const Vector3d lever(-0.4, 0.1, -1.2);
  const auto place = [&](double t) -> Vector3d {
    const Pose p = f.pose(t);
    return core::ecef_of(p.position) + core::ecef_R_ned(p.position.latitude, p.position.longitude) * core::matrix_of(p.attitude) * lever;
  };
  constexpr double h = 2e-3;
  for (double t = 1.0; t < f.duration() - 1; t += 2.3) {
    const Motion m = f.motion(t);
    const Matrix3d R = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude);
    // Rounding of 1e-9 m over 2 h, and h^2 / 6 of a jerk of some m/s^3.
    EXPECT_LT((R.transpose() * (place(t + h) - place(t - h)) / (2 * h) - velocity_at(m, lever)).norm(), 1e-5) << t;
  }
}

}  // namespace
}  // namespace swath::simulate
