// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/strapdown.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "simulate/inertial.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double arcsec = core::degree / 3600;

double angle_between(const Matrix3d& a, const Matrix3d& b) { return core::log_so3(a * b.transpose()).norm(); }

NavState state_of(const test::MotionAt& motion, double t) {
  const test::Truth truth = test::truth_at(motion, t);
  return {t, truth.position, truth.velocity, truth.ecef_R_body};
}

/// A perfect IMU's record of a flight, carried on by nothing else.
struct Flown {
  test::MotionAt motion;
  core::ImuData imu;
  explicit Flown(double seconds) {
    const simulate::PlannedFlight flight = test::survey_flight(20);
    EXPECT_GT(flight.duration(), seconds);
    motion = test::motion_of(flight);
    imu = test::exact_records(motion, {.from = 0, .until = seconds}).imu;
  }
};

TEST(Strapdown, KeepsThePathOfAPerfectImu) {
  const Flown flown(600);
  NavState s = state_of(flown.motion, 0);
  constexpr double minute_position = 0.01, minute_angle = 1 * arcsec, ten_minutes_position = 0.05;
  for (size_t k = 0; k < flown.imu.size(); ++k) {
    advance(s, increment_of(flown.imu, k));
    if (k + 1 != 12000 && k + 1 != flown.imu.size()) continue;
    const NavState truth = state_of(flown.motion, static_cast<double>(k + 1) * 0.005);
    const double position = (s.position - truth.position).norm(), angle = angle_between(s.ecef_R_body, truth.ecef_R_body);
    std::printf("after %zu s: %.2e m, %.2e m/s, %.2e arcsec\n", (k + 1) / 200, position, (s.velocity - truth.velocity).norm(),
                angle / arcsec);
    EXPECT_LT(position, k + 1 == 12000 ? minute_position : ten_minutes_position);
    EXPECT_LT(angle, minute_angle);
  }
}

TEST(Strapdown, GoesBackTheWayItCame) {
  const Flown flown(60);
  const NavState start = state_of(flown.motion, 0);
  NavState s = start;
  for (size_t k = 0; k < flown.imu.size(); ++k) advance(s, increment_of(flown.imu, k));
  for (size_t k = flown.imu.size(); k-- > 0;) {
    const Increment i = increment_of(flown.imu, k);
    advance(s, {-i.angle, -i.velocity, -i.step});
  }
  std::printf("back at the start: %.2e m, %.2e m/s, %.2e rad\n", (s.position - start.position).norm(), (s.velocity - start.velocity).norm(),
              angle_between(s.ecef_R_body, start.ecef_R_body));
  EXPECT_LT((s.position - start.position).norm(), 1e-6);
  EXPECT_LT((s.velocity - start.velocity).norm(), 1e-7);
  EXPECT_LT(angle_between(s.ecef_R_body, start.ecef_R_body), 1e-10);
}

/// Classical coning (the rotation vector sweeps a cone about x) and a force that turns with it, sculling along x: exact increments at 200
/// Hz.
struct Shaken {
  static constexpr double step = 0.005, seconds = 20.0;
  double half_angle, omega, force;
  core::ImuData imu;
  Matrix3d last;                      // body at the end, in the axes of its middle
  Vector3d speed = Vector3d::Zero();  // integral of the specific force there

  Matrix3d attitude(double t) const { return core::exp_so3(half_angle * Vector3d(0, std::cos(omega * t), std::sin(omega * t))); }
  Vector3d force_at(double t) const { return force * Vector3d(0, -std::sin(omega * t), std::cos(omega * t)); }

  Shaken(double cone, double hertz, double acceleration) : half_angle(cone), omega(2 * core::pi * hertz), force(acceleration) {
    const auto n = static_cast<int>(seconds / step + 0.5);
    const double s = std::sin(half_angle), c = 1 - std::cos(half_angle);
    for (int k = 1; k <= n; ++k) {
      const double t0 = (k - 1) * step, t1 = k * step;
      const double cos0 = std::cos(omega * t0), cos1 = std::cos(omega * t1), sin0 = std::sin(omega * t0), sin1 = std::sin(omega * t1);
      imu.time.push_back(t1);
      imu.step.push_back(step);
      // Body rates: -(1 - cos) omega about x, sin half_angle * omega * (-sin, cos) about y and z.
      imu.angle.push_back({-c * omega * step, s * (cos1 - cos0), s * (sin1 - sin0)});
      imu.velocity.push_back(force / omega * Vector3d(0, cos1 - cos0, sin1 - sin0));
      // Simpson over ten parts: exact to 1e-12 of the force.
      for (int p = 0; p < 10; ++p) {
        const double a = t0 + p * step / 10, h = step / 10;
        const auto f = [&](double t) -> Vector3d { return attitude(t) * force_at(t); };
        speed += h / 6 * (f(a) + 4 * f(a + h / 2) + f(a + h));
      }
    }
    last = attitude(seconds);
  }
};

TEST(Strapdown, ConingAndScullingAreTakenOut) {
  const Shaken shaken(1.0 * core::degree, 5.0, 2.0);
  Matrix3d with = shaken.attitude(0), without = with;
  Vector3d fast = Vector3d::Zero(), plain = Vector3d::Zero();
  for (size_t k = 0; k < shaken.imu.size(); ++k) {
    const Increment i = increment_of(shaken.imu, k);
    const Vector3d& a = shaken.imu.angle[k];
    const Vector3d& v = shaken.imu.velocity[k];
    fast += with * (i.velocity + 0.5 * i.angle.cross(i.velocity));
    plain += without * (v + 0.5 * a.cross(v));
    with = with * core::exp_so3(i.angle);
    without = without * core::exp_so3(a);
  }
  const double drift = angle_between(with, shaken.last) / Shaken::seconds,
               plain_drift = angle_between(without, shaken.last) / Shaken::seconds;
  const double push = (fast - shaken.speed).norm() / Shaken::seconds;
  const double plain_push = (plain - shaken.speed).norm() / Shaken::seconds;
  std::printf("coning: %.2e rad/s with the term, %.2e without; sculling: %.2e m/s2, %.2e\n", drift, plain_drift, push, plain_push);
  // What the terms of second order leave out is of the order (omega step)^2 of the terms, 2.5 %.
  EXPECT_LT(drift, 1.2e-7);
  EXPECT_GT(plain_drift, 1.5e-5);
  EXPECT_LT(push, 2e-6);
  EXPECT_GT(plain_push, 50 * push);
}

TEST(Strapdown, FirstIncrementAndUnequalSteps) {
  core::ImuData imu;
  imu.time = {0.01, 0.015};
  imu.step = {0.01, 0.005};
  imu.angle = {{0.02, 0, 0}, {0, 0.01, 0}};
  imu.velocity = {{0, 0, 0.1}, {0.05, 0, 0}};
  EXPECT_EQ(increment_of(imu, 0).angle, imu.angle[0]);
  EXPECT_EQ(increment_of(imu, 0).velocity, imu.velocity[0]);
  const Increment second = increment_of(imu, 1);
  // Half of the first: (0.01, 0, 0) x (0, 0.01, 0) / 12.
  EXPECT_LT((second.angle - Vector3d(0, 0.01, 1e-4 / 12)).norm(), 1e-15);
  // (0.01, 0, 0) x (0.05, 0, 0) + (0, 0, 0.05) x (0, 0.01, 0) = (-5e-4, 0, 0).
  EXPECT_LT((second.velocity - Vector3d(0.05 - 5e-4 / 12, 0, 0)).norm(), 1e-15);
}

TEST(Strapdown, GravityAndItsGradient) {
  constexpr double stated = 0.007;  // share of the gradient's size
  for (const double latitude : {-89.0, -45.0, 0.1, 48.0, 70.0})
    for (const double height : {0.0, 3000.0}) {
      const Vector3d p = core::ecef_of({latitude * core::degree, 0.7, height});
      const Vector3d up = -core::ecef_R_ned(latitude * core::degree, 0.7).col(2);
      EXPECT_LT((gravity_at(p) + core::normal_gravity(latitude * core::degree, height) * up).norm(), 1e-9);
      constexpr double h = 100.0;
      Matrix3d differences;
      for (int i = 0; i < 3; ++i)
        differences.col(i) = (gravity_at(p + h * Vector3d::Unit(i)) - gravity_at(p - h * Vector3d::Unit(i))) / (2 * h);
      const Matrix3d gradient = gravity_gradient_at(p);
      EXPECT_LT((gradient - differences).norm(), stated * differences.norm()) << latitude << " " << height;
    }
}

TEST(Strapdown, TakesOutTheRoundingOfAProduct) {
  const Matrix3d R = core::exp_so3({0.3, -1.1, 0.7});
  Matrix3d off = R;
  off(0, 1) += 1e-6;
  const Matrix3d mended = orthonormal(off);
  EXPECT_LT((mended * mended.transpose() - Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((mended - R).norm(), 1e-6);
}

}  // namespace
}  // namespace swath::trajectory
