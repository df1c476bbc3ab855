// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/inertial.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "simulate/random.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

Flight flight() {
  FlightOptions o;
  return Flight(o, origin, 950.0, plan_lines(o, {}, core::degrees(20).value, 0.02), 5.2, 1);
}

Matrix3d inertial_R_ecef(double t) { return Eigen::AngleAxisd(core::wgs84::omega * t, Vector3d::UnitZ()).toRotationMatrix(); }
Vector3d inertial_position(const Flight& f, double t) { return inertial_R_ecef(t) * core::ecef_of(f.pose(t).position); }
Matrix3d inertial_R_body(const Flight& f, double t) {
  const Pose p = f.pose(t);
  return inertial_R_ecef(t) * core::ecef_R_ned(p.position.latitude, p.position.longitude) * core::matrix_of(p.attitude);
}

TEST(Inertial, IsTheMotionSeenFromInertialSpace) {
  const Flight f = flight();
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
  const Flight f = flight();
  for (const double t : {3.0, 28.3, 77.0}) {
    Increments fine{Vector3d::Zero(), Vector3d::Zero()};
    for (int i = 1; i <= 10; ++i) {
      const Increments part = increments_of(f, t - imu_step + i * imu_step / 10, imu_step / 10);
      fine.angle += part.angle;
      fine.velocity += part.velocity;
    }
    const Increments whole = increments_of(f, t, imu_step);
    EXPECT_LT((whole.angle - fine.angle).norm(), 1e-12);
    EXPECT_LT((whole.velocity - fine.velocity).norm(), 1e-11);
  }
}

TEST(Inertial, GradesRiseInTheirErrors) {
  double navigation = 0, mems = 0;
  for (int s = 0; s < 50; ++s) {
    navigation += std::abs(draw_imu_errors(ImuGrade::navigation, s).gyro_bias[0]);
    mems += std::abs(draw_imu_errors(ImuGrade::mems, s).gyro_bias[0]);
  }
  EXPECT_GT(mems, 500 * navigation);
  EXPECT_EQ(draw_imu_errors(ImuGrade::perfect, 1).angle_walk, 0.0);
}

TEST(Inertial, FilesHoldTheRecords) {
  const test::TemporaryFolder folder;
  FlightOptions o;
  o.lines = 1;
  o.cross_lines = 0;
  const Flight f(o, origin, 950.0, plan_lines(o, {}, 0.3, 0.0), 5.2, 1);
  const core::GpsTime start = core::from_week(2317, 604795.0);
  write_imu(folder / "imu.csv", f, start, {}, 1);
  write_gnss(folder / "gnss.csv", f, start, {core::Metres(-0.4), core::Metres(0.1), core::Metres(-1.2)}, true, 1);
  const std::string imu = test::read_bytes(folder / "imu.csv"), gnss = test::read_bytes(folder / "gnss.csv");
  EXPECT_EQ(std::count(imu.begin(), imu.end(), '\n'), 1 + static_cast<long>(std::floor(f.duration() / imu_step)));
  EXPECT_EQ(std::count(gnss.begin(), gnss.end(), '\n'), 2 + static_cast<long>(std::floor(f.duration() / gnss_step)));
  EXPECT_NE(imu.find("\n604795.0050,"), std::string::npos);
  EXPECT_NE(imu.find("\n604805.0000,"), std::string::npos);  // counts on past the week's end
  EXPECT_NE(gnss.find("\n604795.200,"), std::string::npos);
}

}  // namespace
}  // namespace swath::simulate
