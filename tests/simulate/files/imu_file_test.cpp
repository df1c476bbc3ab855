// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/imu_file.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "io/text/delimited.h"
#include "io/text/value_file.h"
#include "simulate/inertial.h"
#include "simulate/planned_flight.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};
const core::GpsTime start = core::from_week(2317, 604795.0);

PlannedFlight flight() {
  FlightOptions o;
  o.lines = 1;
  o.cross_lines = 0;
  o.line_length = core::Metres(3000.0);
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, 0.3, 0.0), 5.2, 1);
}

/// The rows of a table with seven columns.
std::vector<std::array<double, 7>> rows_of(const std::filesystem::path& file) {
  io::DelimitedReader reader(file, io::inspect_delimited(file), {0, 1, 2, 3, 4, 5, 6});
  std::vector<std::array<double, 7>> out;
  std::array<double, 7> row{};
  while (reader.next(row.data())) out.push_back(row);
  return out;
}

std::vector<std::array<double, 7>> written(const test::TemporaryFolder& folder, const Flight& f, const ImuOptions& imu, bool noise_free) {
  std::filesystem::create_directories(folder / "truth");
  write_imu(folder.path(), f, start, imu, noise_free, 3);
  return rows_of(folder / "imu.csv");
}

Vector3d angle_of(const std::array<double, 7>& row) { return {row[1], row[2], row[3]}; }
Vector3d velocity_of(const std::array<double, 7>& row) { return {row[4], row[5], row[6]}; }

TEST(ImuFile, PerfectIncrementsIntegrateBackToAttitudeAndVelocity) {
  const PlannedFlight f = flight();
  for (const double rate : {50.0, 200.0, 1000.0}) {
    const test::TemporaryFolder folder;
    ImuOptions imu;
    imu.rate.value = rate;
    const auto rows = written(folder, f, imu, true);
    ASSERT_EQ(rows.size(), static_cast<size_t>(f.duration() * rate));
    EXPECT_EQ(rows.back()[0], 604795.0 + f.duration());  // counts on past the week's end, and ends with the flight
    // In inertial axes: the body turns by its increments, the velocity grows by turned increments and gravitation.
    const auto inertial_R_ned = [&](double t, const core::Geodetic& p) -> Matrix3d {
      return Eigen::AngleAxisd(core::wgs84::omega * t, Vector3d::UnitZ()).toRotationMatrix() * core::ecef_R_ned(p.latitude, p.longitude);
    };
    const Pose first = f.pose(0.0);
    Matrix3d R = inertial_R_ned(0.0, first.position) * core::matrix_of(first.attitude);
    Vector3d gained = Vector3d::Zero(), last_angle = Vector3d::Zero(), last_velocity = Vector3d::Zero();
    Vector3d gravity = Vector3d::Zero();
    const double step = 1.0 / rate;
    for (size_t k = 0; k < rows.size(); ++k) {
      const Vector3d angle = angle_of(rows[k]), velocity = velocity_of(rows[k]);
      // Coning and sculling from two increments each (Savage 1998).
      const Vector3d rotation = angle + last_angle.cross(angle) / 12.0;
      gained += R * (velocity + 0.5 * angle.cross(velocity) + (last_angle.cross(velocity) + last_velocity.cross(angle)) / 12.0);
      R = R * core::exp_so3(rotation);
      last_angle = angle;
      last_velocity = velocity;
      const double middle = (static_cast<double>(k) + 0.5) * step;
      const Pose p = f.pose(middle);
      const Vector3d ecef = core::ecef_of(p.position);
      const Vector3d centrifugal = core::wgs84::omega * core::wgs84::omega * Vector3d(ecef.x(), ecef.y(), 0);
      gravity += step * (inertial_R_ned(middle, p.position) * Vector3d(0, 0, core::normal_gravity(p.position.latitude, p.position.height)) -
                         Eigen::AngleAxisd(core::wgs84::omega * middle, Vector3d::UnitZ()).toRotationMatrix() * centrifugal);
    }
    const double T = f.duration();
    const Pose last = f.pose(T);
    const Matrix3d truth = inertial_R_ned(T, last.position) * core::matrix_of(last.attitude);
    // What two increments leave of coning is largest at 50 Hz.
    EXPECT_LT(core::log_so3(truth.transpose() * R).norm(), rate < 100 ? 2e-6 : 1e-8) << rate;
    const auto inertial_velocity = [&](double t) -> Vector3d {
      const Motion m = f.motion(t);
      const Matrix3d inertial_R_ecef = Eigen::AngleAxisd(core::wgs84::omega * t, Vector3d::UnitZ()).toRotationMatrix();
      return inertial_R_ned(t, m.pose.position) * m.velocity +
             inertial_R_ecef * Vector3d(0, 0, core::wgs84::omega).cross(core::ecef_of(m.pose.position));
    };
    EXPECT_LT((inertial_velocity(0.0) + gained + gravity - inertial_velocity(T)).norm(), rate < 100 ? 1e-3 : 1e-5) << rate;
  }
}

TEST(ImuFile, RatesAreTheIncrementsMeans) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder one, two;
  ImuOptions imu;
  const auto increments = written(one, f, imu, false);
  imu.kind = io::ImuKind::rates;
  const auto rates = written(two, f, imu, false);
  ASSERT_EQ(increments.size(), rates.size());
  for (size_t k = 0; k < rates.size(); k += 11) {
    EXPECT_LT((angle_of(rates[k]) * 0.005 - angle_of(increments[k])).norm(), 1e-14);
    EXPECT_LT((velocity_of(rates[k]) * 0.005 - velocity_of(increments[k])).norm(), 1e-12);
  }
}

TEST(ImuFile, AxesAndMountingAreTakenBackByTheirDescription) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder plain, turned;
  ImuOptions imu;
  const auto truth = written(plain, f, imu, true);
  imu.axes = {"y", "x", "-z"};
  imu.roll = core::degrees(3.0);
  imu.pitch = core::degrees(-20.0);
  imu.heading = core::degrees(100.0);
  const auto rows = written(turned, f, imu, true);
  const io::ImuFile told = describe_imu_file(imu, start);
  const Matrix3d mounting = core::matrix_of({told.roll.value, told.pitch.value, told.heading.value});
  for (size_t k = 0; k < rows.size(); k += 17) {
    // As survey.toml has it: forward, right, down of the sensor are y, x and -z of the record.
    const Vector3d angle(rows[k][2], rows[k][1], -rows[k][3]), velocity(rows[k][5], rows[k][4], -rows[k][6]);
    EXPECT_LT((mounting * angle - angle_of(truth[k])).norm(), 1e-13);
    EXPECT_LT((mounting * velocity - velocity_of(truth[k])).norm(), 1e-12);
  }
}

TEST(ImuFile, WhiteNoiseScaleBiasAndDriftAreThoseOfTheModel) {
  core::ImuErrorModel model = core::error_model_of(core::ImuGrade::mems);
  model.drift_time.value = 20.0;
  constexpr double step = 0.01;
  constexpr int n = 2000000;  // 20 000 s: 500 independent values of the drift, three axes
  double gyro_white = 0, force_white = 0, drift = 0, lagged = 0;
  ImuErrors errors(model, step, 5);
  constexpr int lag = 2000;  // 20 s
  std::vector<Vector3d> drifts;
  const Vector3d angle_true(1e-3, -2e-3, 3e-3), velocity_true(0.01, 0.02, -0.09);
  for (int k = 1; k <= n; ++k, errors.advance()) {
    Vector3d angle = angle_true, velocity = velocity_true;
    errors.measure(k, angle, velocity);
    const auto& c = errors.constant();
    const Vector3d white = angle - angle_true - angle_true.cwiseProduct(c.gyro_scale) - step * (c.gyro_bias + errors.gyro_drift());
    const Vector3d force = velocity - velocity_true - velocity_true.cwiseProduct(c.accelerometer_scale) -
                           step * (c.accelerometer_bias + errors.accelerometer_drift());
    gyro_white += white.squaredNorm();
    force_white += force.squaredNorm();
    drifts.push_back(errors.gyro_drift());
  }
  for (size_t i = 0; i + lag < drifts.size(); ++i) {
    drift += drifts[i].squaredNorm();
    lagged += drifts[i].dot(drifts[i + lag]);
  }
  const auto expected = [&](double walk) { return 3.0 * n * walk * walk * step; };
  EXPECT_NEAR(gyro_white / expected(model.angular_random_walk.value), 1.0, 0.003);  // 6e6 values, five sigma
  EXPECT_NEAR(force_white / expected(model.velocity_random_walk.value), 1.0, 0.003);
  const double m = 3.0 * static_cast<double>(drifts.size() - lag);
  EXPECT_NEAR(drift / m / std::pow(model.gyro_drift.value, 2), 1.0, 0.18);  // 1500 independent values, five sigma
  EXPECT_NEAR(lagged / drift, std::exp(-1.0), 0.18);
}

TEST(ImuFile, ConstantPartsAreOfTheirSigmasOverManySeeds) {
  const core::ImuErrorModel model = core::error_model_of(core::ImuGrade::tactical);
  constexpr int seeds = 2000;
  Eigen::Array4d square = Eigen::Array4d::Zero();
  for (int seed = 0; seed < seeds; ++seed) {
    const ImuErrors::Constant c = ImuErrors(model, 0.005, seed).constant();
    square += Eigen::Array4d(c.gyro_bias.squaredNorm(), c.gyro_scale.squaredNorm(), c.accelerometer_bias.squaredNorm(),
                             c.accelerometer_scale.squaredNorm());
  }
  square = (square / (3.0 * seeds)).sqrt();
  // 6000 values: five sigma of a standard deviation are 4.6 %.
  EXPECT_NEAR(square[0] / model.gyro_bias.value, 1.0, 0.05);
  EXPECT_NEAR(square[1] / model.gyro_scale.value, 1.0, 0.05);
  EXPECT_NEAR(square[2] / model.accelerometer_bias.value, 1.0, 0.05);
  EXPECT_NEAR(square[3] / model.accelerometer_scale.value, 1.0, 0.05);
}

TEST(ImuFile, TruthStatesWhatWasDrawn) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  ImuOptions imu;
  imu.spec.grade = core::ImuGrade::consumer;
  imu.spec.angular_random_walk.emplace(0.0);
  imu.spec.velocity_random_walk.emplace(0.0);
  const auto rows = written(folder, f, imu, false);
  const core::Value truth = io::read_value_file(folder / "truth/imu.json");
  const auto drift = rows_of(folder / "truth/imu_drift.csv");
  EXPECT_EQ(drift.size(), static_cast<size_t>(f.duration()) + 1u);
  const auto three = [&](const char* name) -> Vector3d {
    const auto& v = truth.find(name)->items();
    return {v[0].as_number(), v[1].as_number(), v[2].as_number()};
  };
  // Without noise a record is told by the truth alone.
  for (const size_t second : {size_t{0}, size_t{7}, drift.size() - 1}) {
    size_t k = 0;
    while (rows[k][0] < drift[second][0] - 1e-6) ++k;
    const Increments made = increments_of(f, rows[k][0] - 604795.0, 0.005);
    const Vector3d angle = made.angle.cwiseProduct(Vector3d::Ones() + three("gyro_scale_factor")) +
                           0.005 * (three("gyro_bias_rad_per_s") + angle_of(drift[second]));
    const Vector3d velocity = made.velocity.cwiseProduct(Vector3d::Ones() + three("accelerometer_scale_factor")) +
                              0.005 * (three("accelerometer_bias_m_per_s2") + velocity_of(drift[second]));
    EXPECT_LT((angle - angle_of(rows[k])).norm(), 1e-12);
    EXPECT_LT((velocity - velocity_of(rows[k])).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace swath::simulate
