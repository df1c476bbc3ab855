// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/correlated_errors.h"

#include <gtest/gtest.h>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::georef {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr int n = latency + 1;

struct Made {
  core::Calibration calibration;
  core::SensorSigma sensor;
  trajectory::Pose pose;
  trajectory::PoseSigma place;
  core::CalibrationResponse response;
  Made() {
    calibration.roll = core::degrees(0.4);
    calibration.pitch = core::degrees(-0.3);
    calibration.heading = core::degrees(0.8);
    calibration.lever_arm_scanner = {core::Metres(0.3), core::Metres(-0.2), core::Metres(0.5)};
    calibration.range_offset = core::Metres(0.07);
    sensor.roll = sensor.pitch = core::degrees(0.008);
    sensor.heading = core::degrees(0.015);
    sensor.range_offset = core::Metres(0.02);
    sensor.range_scale = 2e-5;
    sensor.scan_offset = core::degrees(0.002);
    sensor.scan_scale = 1e-4;
    sensor.latency = core::Seconds(2e-4);
    const core::Geodetic at{core::degrees(48.0).value, core::degrees(11.0).value, 900.0};
    pose.position = core::ecef_of(at);
    pose.ecef_R_body = core::ecef_R_ned(at.latitude, at.longitude) * core::matrix_of({0.06, -0.04, 2.1});
    pose.velocity = pose.ecef_R_body * Vector3d(58.0, 1.0, -0.5);
    pose.rate = Vector3d(0.02, -0.01, 0.03);
    place = {0.02, 0.03, 0.05, 1.2e-4, 1.1e-4, 2.4e-4};
  }
  void correlate() {
    sensor.correlation.assign(n * n, 0.0);
    for (int k = 0; k < n; ++k) sensor.correlation[static_cast<size_t>(k * n + k)] = 1.0;
    const auto set = [&](int a, int b, double v) {
      sensor.correlation[static_cast<size_t>(a * n + b)] = sensor.correlation[static_cast<size_t>(b * n + a)] = v;
    };
    set(boresight_roll, scan_scale, 0.3);
    set(boresight_pitch, lever_forward, -0.7);
    set(range_offset, scan_scale, -0.6);
  }
  void respond() {
    core::CalibrationResponse::Matrix G = core::CalibrationResponse::Matrix::Zero();
    G(3, boresight_roll) = -0.6;
    G(4, boresight_pitch) = -0.3;
    G(0, boresight_pitch) = 100.0;
    G(2, range_offset) = 0.4;
    response.time = {0.0, 10.0};
    response.per_unit = {G, G};
  }
};

// J S J^T over calibration and trajectory at once, in ecef.
Matrix3d expected(const Made& m, const Jacobian& J) {
  const Variances v = variances(m.sensor, m.place);
  MatrixXd S(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double r = i == j ? 1.0 : m.sensor.correlation.empty() ? 0.0 : m.sensor.correlation[static_cast<size_t>(i * n + j)];
      S(i, j) = r * std::sqrt(v[static_cast<size_t>(i)] * v[static_cast<size_t>(j)]);
    }
  const core::CalibrationResponse::Matrix G = m.response.at(5.0);
  const MatrixXd Jt = J.middleCols(position_north, 6), Jc = J.leftCols(n) + Jt * G;
  Matrix3d C = Jc * S * Jc.transpose();
  const MatrixXd by_calibration = G * S * G.transpose();
  for (int k = 0; k < 6; ++k) {
    const double own = v[static_cast<size_t>(position_north + k)] - by_calibration(k, k);
    EXPECT_GT(own, 0.0);
    C += own * Jt.col(k) * Jt.col(k).transpose();
  }
  return C;
}

void compare(const Made& m) {
  const ShotGeometry g({}, m.calibration);
  const CorrelatedErrors errors(g, m.sensor, m.response);
  const Matrix3d ned = ecef_R_ned_at(m.pose);
  const Matrix3d base_R_ned = m.pose.ecef_R_body.transpose() * ned;
  const SharedErrors Z = errors.at(5.0, m.place, base_R_ned);
  for (const double angle : {-0.4, 0.0, 0.3}) {
    const Return r{angle, 0.0, 700.0 / std::cos(angle)};
    Jacobian J;
    g.ecef_point(m.pose, r, J);
    const Matrix3d C = expected(m, J);
    const Vector3d q = g.range(r.range) * (g.body_R_scanner() * g.beam()(angle, 0.0).direction);
    const PointTerms p{q,       q / q.norm(),
                       r.range, g.range(r.range) * (g.body_R_scanner() * g.beam()(angle, 0.0).by_angle),
                       angle,   m.pose.ecef_R_body.transpose() * m.pose.velocity + m.pose.rate.cross(g.lever_arm() + q)};
    const PointVariance v = variance_of(p, Z, base_R_ned.col(2));
    EXPECT_NEAR(v.total, C.trace(), 1e-9 * C.trace());
    EXPECT_NEAR(v.down, ned.col(2).dot(C * ned.col(2)), 1e-9 * C.trace());
  }
}

TEST(CorrelatedErrors, IndependentErrorsAreTheSumOfSquares) {
  const Made m;
  EXPECT_FALSE(CorrelatedErrors(ShotGeometry({}, m.calibration), m.sensor, m.response).any());
  compare(m);
}

TEST(CorrelatedErrors, CorrelationsOfTheCalibration) {
  Made m;
  m.correlate();
  EXPECT_TRUE(CorrelatedErrors(ShotGeometry({}, m.calibration), m.sensor, m.response).any());
  compare(m);
}

TEST(CorrelatedErrors, ATrajectoryThatRespondsToTheCalibration) {
  Made m;
  m.respond();
  compare(m);
  m.correlate();
  compare(m);
}

// A boresight roll that the corrections have taken up wholly: the points do not show it.
TEST(CorrelatedErrors, WhatTheCorrectionsTookUpIsNotInThePoints) {
  Made m;
  m.calibration = {};
  m.sensor = {};
  m.sensor.roll = core::Radians(2e-4);
  m.sensor.pitch = m.sensor.heading = core::Radians(0.0);
  m.sensor.lever_arm = core::Metres(0.0);
  m.pose.ecef_R_body = ecef_R_ned_at(m.pose);
  m.place = {0.0, 0.0, 0.0, 2e-4, 0.0, 0.0};
  const ShotGeometry g({}, m.calibration);
  const PointTerms p{Vector3d(0.0, 200.0, 700.0), Vector3d(0.0, 0.27, 0.96), 728.0, Vector3d(0.0, 700.0, -200.0), 0.28, Vector3d::UnitX()};
  const auto sigma = [&](const core::CalibrationResponse& response) {
    return std::sqrt(
        variance_of(p, CorrelatedErrors(g, m.sensor, response).at(5.0, m.place, Matrix3d::Identity()), Vector3d::UnitZ()).total);
  };
  EXPECT_NEAR(sigma({}), std::sqrt(2.0) * 2e-4 * 728.0, 1e-3);
  core::CalibrationResponse taken_up;
  taken_up.time = {0.0};
  taken_up.per_unit = {core::CalibrationResponse::Matrix::Zero()};
  taken_up.per_unit[0](3, boresight_roll) = -1.0;
  EXPECT_NEAR(sigma(taken_up), 0.0, 1e-6);
}

}  // namespace
}  // namespace swath::georef
