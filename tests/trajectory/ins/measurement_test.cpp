// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/measurement.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Layout everything(true, true, true, true, true);
// A gyro bias of 1 rad/s counts as much as its lever: all states in their own units, differences of this size.
constexpr double step = 1e-5;

Estimate estimate(std::uint64_t seed, double latency) {
  test::Dice dice(seed);
  Estimate e;
  e.nav.position = core::ecef_of({0.8, 0.2, 900.0});
  e.nav.velocity = 40 * dice.vector();
  e.nav.ecef_R_body = core::exp_so3(dice.vector());
  e.lever = 2 * dice.vector();
  e.fix = dice.vector();
  e.latency = latency;
  e.track = 0.05 * Eigen::Vector2d(dice.normal(), dice.normal());
  return e;
}

/// Central differences of a measurement by each error; the body's rate is what the gyros say without their bias.
template <int Rows>
void expect_design(const Layout& l, const Estimate& e, const Vector3d& rate, double tolerance,
                   const std::function<Prediction<Rows>(const Estimate&, const Vector3d&)>& predict) {
  const auto design = predict(e, rate).design;
  ASSERT_EQ(design.cols(), l.size);
  for (int j = 0; j < l.size; ++j) {
    // Positions of 6e6 m round at 1e-9 m: their own difference is taken wide.
    const double h = j < 3 ? 1.0 : step;
    StateVector error = StateVector::Zero(l.size);
    error[j] = h;
    Estimate plus = e, minus = e;
    plus.correct(l, error);
    minus.correct(l, -error);
    const auto turned = [&](const Estimate& x) -> Vector3d { return rate - (x.gyro_bias - e.gyro_bias); };
    const Eigen::Matrix<double, Rows, 1> by = (predict(plus, turned(plus)).value - predict(minus, turned(minus)).value) / (2 * h);
    for (int i = 0; i < Rows; ++i) EXPECT_NEAR(design(i, j), by[i], tolerance) << "row " << i << ", column " << j;
  }
}

// Rounding of ecef metres over the difference: 1e-9 / 1e-5; terms of the Earth's rate on the lever arm that are left out: 7e-5 * 4 m.
constexpr double rounding = 4e-4;

TEST(Measurement, FixAndItsDesign) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    test::Dice dice(seed + 50);
    const Vector3d rate = 0.2 * dice.vector();
    Matrix3d spread;
    spread << dice.vector(), dice.vector(), dice.vector();
    spread *= 0.02;
    for (const Layout& l : {everything, Layout(), Layout(true, true, false, false, false)})
      expect_design<3>(l, estimate(seed, 0.0), rate, rounding,
                       [&](const Estimate& e, const Vector3d& w) { return predict_fix(l, e, w, spread); });
    // A latency of 5 ms moves the fix by 5e-3 of the velocity, which the design leaves out.
    expect_design<3>(everything, estimate(seed, 0.005), rate, 0.005 * 4 + rounding,
                     [&](const Estimate& e, const Vector3d& w) { return predict_fix(everything, e, w, spread); });
  }
}

TEST(Measurement, FixIsTheAntennaOfAFlight) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(1));
  constexpr double late = 0.02;
  for (const double t : {5.0, 20.0}) {
    const test::Records exact = test::exact_records(motion, {.from = t, .until = t + 1});
    const test::Truth truth = test::truth_at(motion, t);
    Estimate e;
    e.nav = {t, truth.position, truth.velocity, truth.ecef_R_body};
    e.lever = test::Sensors().lever;
    const Vector3d rate = exact.imu.angle[0] / exact.imu.step[0];
    EXPECT_LT((predict_fix(everything, e, rate, Matrix3d::Zero()).value - exact.gnss.position[0]).norm(), 1e-8);
    // The mean rate of the first 5 ms stands for that at their beginning: 0.2 rad/s^2 * 2.5 ms * 1.3 m.
    EXPECT_LT((predict_velocity(everything, e, rate).value - exact.gnss.velocity[0]).norm(), 1e-3);
    EXPECT_LT((antenna_velocity(e, rate) - exact.gnss.velocity[0]).norm(), 1e-3);
    // A fix that was stamped 20 ms early lies that much farther on; half of a 3 m/s^2 acceleration is left out.
    e.latency = late;
    const test::Records later = test::exact_records(motion, {.from = t + late, .until = t + 1});
    EXPECT_LT((predict_fix(everything, e, rate, Matrix3d::Zero()).value - later.gnss.position[0]).norm(), 0.5 * 3 * late * late);
    // One unit of fix error north.
    e.latency = 0;
    e.fix = Vector3d(1, 0, 0);
    Matrix3d spread = Matrix3d::Zero();
    spread.col(0) = Vector3d(0.01, 0.02, 0.03);
    EXPECT_LT((predict_fix(everything, e, rate, spread).value - exact.gnss.position[0] - Vector3d(0.01, 0.02, 0.03)).norm(), 1e-8);
  }
}

TEST(Measurement, VelocityAndItsDesign) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    test::Dice dice(seed + 60);
    const Vector3d rate = 0.2 * dice.vector();
    for (const Layout& l : {everything, Layout()})
      expect_design<3>(l, estimate(seed, 0.003), rate, rounding,
                       [&](const Estimate& e, const Vector3d& w) { return predict_velocity(l, e, w); });
  }
}

TEST(Measurement, WheelsAndTheirDesign) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    test::Dice dice(seed + 70);
    const Vector3d rate = 0.2 * dice.vector(), wheel = dice.vector();
    for (const Layout& l : {everything, Layout()}) {
      double forward = 0;
      expect_design<2>(l, estimate(seed, 0.0), rate, 1e-6,
                       [&](const Estimate& e, const Vector3d& w) { return predict_wheels(l, e, w, wheel, forward); });
    }
  }
}

TEST(Measurement, WheelsOfADriveDoNotSlip) {
  // An IMU turned by 2 and 1 deg against the vehicle, half a metre beside and above a rear axle that lies 1.2 m behind.
  constexpr double azimuth = 2 * core::degree, elevation = 1 * core::degree;
  const test::Drive drive({{0, 1}}, azimuth, elevation);
  for (const double t : {10.0, 33.0, 70.0}) {
    const simulate::Motion m = drive(t);
    const test::Truth axle = test::truth_at(drive, t);
    const Vector3d wheel(-1.2, 0.5, 0.6);
    const Vector3d rate = core::matrix_of(m.pose.attitude).transpose() * Vector3d(0, 0, m.attitude_rate.z());
    Estimate e;
    e.nav = {t, axle.position - axle.ecef_R_body * wheel, axle.velocity - axle.ecef_R_body * rate.cross(wheel), axle.ecef_R_body};
    e.track = {azimuth, elevation};
    double forward = 0;
    const Prediction<2> p = predict_wheels(everything, e, rate, wheel, forward);
    // Angles count as small: cubes of 2 deg, and the square for what the elevation takes of the azimuth.
    EXPECT_LT(p.value.norm(), 2e-3) << t;
    EXPECT_NEAR(forward, m.velocity.norm(), 0.02) << t;
    e.track.setZero();
    EXPECT_GT(predict_wheels(everything, e, rate, wheel, forward).value.norm(), 0.3) << "the axis makes no difference";
  }
}

}  // namespace
}  // namespace swath::trajectory
