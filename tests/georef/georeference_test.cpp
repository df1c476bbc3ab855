// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/georeference.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>
#include <thread>

#include "core/error.h"
#include "tests/calib/reference_data.h"
#include "tests/calib/survey_support.h"
#include "tests/georef/point_covariance.h"

namespace swath::test {}
namespace swath::georef {
namespace test {
using namespace swath::calib::test;
using namespace swath::test;
}  // namespace test
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::deg;

constexpr double start = 1.4e9;
const Vector3d origin(612000.0, 5300000.0, 0.0);

const core::Crs& utm() {
  static const core::Crs crs("EPSG:32632");
  return crs;
}

core::Shots some_shots(core::ScannerModel model, size_t n) {
  core::Shots shots = test::zigzag(n, start + 1.0, 20000.0, 950.0);
  if (model == core::ScannerModel::conical || model == core::ScannerModel::palmer)
    for (size_t i = 0; i < n; ++i) shots.angle[i] = 0.01 * static_cast<double>(i);
  if (model == core::ScannerModel::beam)
    for (size_t i = 0; i < n; ++i) shots.forward.push_back(0.1 * std::sin(0.001 * static_cast<double>(i)));
  return shots;
}

core::SensorSigma every_sigma() {
  core::SensorSigma sigma;
  sigma.range_offset = core::Metres(0.01);
  sigma.range_scale = 2e-5;
  sigma.scan_offset = core::degrees(0.002);
  sigma.scan_scale = 2e-4;
  sigma.latency = core::Seconds(2e-4);
  sigma.time = core::Seconds(1e-4);
  sigma.beam_divergence = core::Radians(4e-4);
  return sigma;
}

TEST(Georeference, BatchesAgreeWithTheSingleShotAndProj) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const core::Transform proj(core::wgs84_ecef(), utm());
  constexpr double sigma_tolerance = 3e-3;       // the turn within an interval: 0.5 mrad, against sigmas that lie mostly level
  constexpr double position_tolerance = 2.1e-5;  // m: the patches' own, plus 1e-8 of the kernel
  for (const core::ScannerModel model : test::all_models)
    for (const bool air : {false, true}) {
      const core::Scanner scanner = test::scanner_of(model, air);
      const core::Calibration calibration = test::some_calibration();
      const core::Shots shots = some_shots(model, 3000);
      core::Block out;
      const core::SensorSigma sigma = every_sigma();
      const Georeferencer g(scanner, calibration, sigma, flight, utm(), origin);
      const Counts counts = g.run(shots, out);
      ASSERT_EQ(counts.georeferenced, shots.size());
      ASSERT_EQ(out.size(), shots.size());
      const ShotGeometry single(scanner, calibration);
      for (size_t i = 0; i < out.size(); i += 7) {
        const double t = single.time(shots.time[i]);
        const Return record{shots.angle[i], shots.forward.empty() ? 0.0 : shots.forward[i], shots.range[i]};
        const trajectory::Pose pose = *flight.pose_at(t);
        Jacobian J;
        const Vector3d ecef = single.ecef_point(pose, record, J);
        const Vector3d map = proj(ecef) - origin;
        ASSERT_LT((Vector3d(out.x[i], out.y[i], out.z[i]) - map).cwiseAbs().maxCoeff(), position_tolerance)
            << "model " << static_cast<int>(model) << " return " << i;
        EXPECT_EQ(out.time[i], t);
        EXPECT_FLOAT_EQ(out.range[i], static_cast<float>(single.range(record.range)));
        // Standard deviations of the fast form against J S J^T.
        const Vector3d beam = ecef_R_ned_at(pose).transpose() * pose.ecef_R_body * single.body_R_scanner() *
                              (single.range(record.range) * single.beam()(single.angle(record.angle), record.forward).direction);
        const Matrix3d C = covariance(ned_jacobian(J, pose), variances(sigma, flight.sigma_at(t)), beam, sigma.beam_divergence.value);
        EXPECT_NEAR(out.sigma_h[i], std::sqrt(C(0, 0) + C(1, 1)), sigma_tolerance * out.sigma_h[i]);
        EXPECT_NEAR(out.sigma_v[i], std::sqrt(C(2, 2)), sigma_tolerance * out.sigma_v[i]);
        // The beam against the vertical at the ground.
        const core::Geodetic ground = core::geodetic_of(ecef);
        const double incidence =
            std::acos((ecef_R_ned_at(pose) * beam).normalized().dot(core::ecef_R_ned(ground.latitude, ground.longitude).col(2)));
        EXPECT_NEAR(out.incidence[i], incidence, 2e-6);
      }
    }
}

TEST(Georeference, ScanAngleIsTheCalibratedOneInHalfATurn) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  core::Shots shots = test::zigzag(2, start + 1.0, 1000.0, 900.0);
  shots.angle = {0.2, 2.0 * core::pi - 0.3};  // an encoder that counts on
  core::Calibration c;
  c.scan_offset = core::Radians(0.01);
  core::Block out;
  Georeferencer({}, c, {}, flight, utm(), origin).run(shots, out);
  EXPECT_FLOAT_EQ(out.scan_angle[0], 0.21f);
  EXPECT_FLOAT_EQ(out.scan_angle[1], -0.29f);
  core::Scanner cone;
  cone.model = core::ScannerModel::conical;
  shots.angle = {90.0 * deg, -90.0 * deg};
  out = {};
  Georeferencer(cone, {}, {}, flight, utm(), origin).run(shots, out);
  EXPECT_FLOAT_EQ(out.scan_angle[0], static_cast<float>(cone.cone_angle.value));
  EXPECT_FLOAT_EQ(out.scan_angle[1], static_cast<float>(-cone.cone_angle.value));
}

// Ten records a second in a steep turn: rotations within an interval too wide for the series.
TEST(Georeference, CoarseTrajectoriesTurnExactly) {
  const core::TrajectoryData fine = test::curved_flight(start, 1600.0);
  core::TrajectoryData d;
  for (size_t i = 0; i < fine.size(); i += 20) {
    d.time.push_back(fine.time[i]);
    d.latitude.push_back(fine.latitude[i]), d.longitude.push_back(fine.longitude[i]), d.height.push_back(fine.height[i]);
    d.roll.push_back(fine.roll[i] * 8.0), d.pitch.push_back(fine.pitch[i]), d.heading.push_back(fine.heading[i]);
  }
  const trajectory::Trajectory flight(d);
  const core::Shots shots = test::zigzag(4000, start + 1.0, 1000.0, 900.0);
  const ShotGeometry single(test::scanner_of(core::ScannerModel::mirror, true), test::some_calibration());
  const Georeferencer g(test::scanner_of(core::ScannerModel::mirror, true), test::some_calibration(), {}, flight, utm(), origin);
  core::Block out;
  ASSERT_EQ(g.run(shots, out).georeferenced, shots.size());
  const core::Transform proj(core::wgs84_ecef(), utm());
  double widest = 0.0;
  for (size_t i = 0; i < out.size(); ++i) {
    const trajectory::Pose pose = *flight.pose_at(single.time(shots.time[i]));
    const Vector3d map = proj(single.ecef_point(pose, {shots.angle[i], 0.0, shots.range[i]})) - origin;
    ASSERT_LT((Vector3d(out.x[i], out.y[i], out.z[i]) - map).cwiseAbs().maxCoeff(), 2.5e-5) << i;
    widest = std::max(widest, pose.rate.norm() * 0.1);
  }
  EXPECT_GT(widest, 0.05);
}

TEST(Georeference, WhatHasNoPlaceIsCountedAndLeftOut) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  core::Shots shots = test::zigzag(1000, start + 11.9, 5000.0, 950.0);  // the trajectory ends within
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  shots.range[3] = nan;
  shots.range[4] = 0.0;
  shots.range[5] = -3.0;
  shots.range[6] = std::numeric_limits<double>::infinity();
  shots.angle[7] = nan;
  shots.time[8] = nan;
  shots.time[9] = start - 5.0;
  const Georeferencer g({}, {}, {}, flight, utm(), origin);
  core::Block out;
  const Counts c = g.run(shots, out);
  EXPECT_EQ(c.no_range, 4u);
  EXPECT_EQ(c.no_beam, 1u);
  EXPECT_EQ(c.no_map, 0u);
  EXPECT_NEAR(static_cast<double>(c.outside), 501.0, 2.0);
  EXPECT_EQ(c.georeferenced + c.outside + c.no_range + c.no_beam, shots.size());
  EXPECT_EQ(c.outside_times.n + 1, c.outside);  // one has no time
  EXPECT_LT(c.outside_times.first, c.outside_times.last);
  EXPECT_EQ(out.size(), c.georeferenced);
  EXPECT_EQ(out.record[3], 10u);  // records keep their row: 3 to 9 are gone
  core::for_each_column([&](core::Column column, std::string_view name, auto member) {
    if (core::columns_of(out).has(column)) {
      EXPECT_EQ((out.*member).size(), out.size()) << name;
    }
  });
}

TEST(Georeference, ResultsDoNotDependOnBatchesOrThreads) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const core::Shots shots = test::zigzag(20000, start + 1.0, 5000.0, 950.0);
  const Georeferencer g(test::scanner_of(core::ScannerModel::mirror, true), test::some_calibration(), {}, flight, utm(), origin);
  core::Block whole;
  g.run(shots, whole);
  const auto part = [&](size_t first, size_t n) {
    core::Shots s;
    core::for_each_column(shots, s, [&](const auto& from, auto& to) {
      if (!from.empty()) to.assign(from.begin() + static_cast<long>(first), from.begin() + static_cast<long>(first + n));
    });
    return s;
  };
  std::vector<core::Block> parts(4);
  std::vector<std::thread> threads;
  const Georeferencer fresh(test::scanner_of(core::ScannerModel::mirror, true), test::some_calibration(), {}, flight, utm(), origin);
  for (size_t k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (size_t j = 0; j < 50; ++j) fresh.run(part(k * 5000 + j * 100, 100), parts[k]);
    });
  for (std::thread& t : threads) t.join();
  core::Block joined = parts[0];
  for (size_t k = 1; k < 4; ++k) core::append(joined, parts[k]);
  core::for_each_column([&](core::Column, std::string_view name, auto member) { EXPECT_EQ(joined.*member, whole.*member) << name; });
}

TEST(Georeference, AppendsKeepingOtherColumns) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const Georeferencer g({}, {}, {}, flight, utm(), origin, false);
  core::Block out;
  g.run(test::zigzag(10, start + 1.0, 1000.0, 900.0), out);
  EXPECT_TRUE(out.sigma_h.empty());
  core::add_columns(out, {core::Column::classification});
  g.run(test::zigzag(5, start + 2.0, 1000.0, 900.0), out);
  EXPECT_EQ(out.size(), 15u);
  EXPECT_EQ(out.classification.size(), 15u);
  out.origin.x() += 1.0;
  EXPECT_THROW(g.run(test::zigzag(5, start + 2.0, 1000.0, 900.0), out), core::Error);
}

// Draws of everything that SensorSigma and the trajectory's sigmas say: the scatter of the points must be what sigma_h and sigma_v state.
TEST(Georeference, MonteCarloMeetsTheStatedSigmas) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, 1.0);
  constexpr int draws = 8000;  // standard error of a sigma: 0.8 %
  constexpr double low = 0.95, high = 1.05;
  const core::SensorSigma sigma = every_sigma();
  const trajectory::PoseSigma place{0.03, 0.02, 0.05, 0.003 * deg, 0.002 * deg, 0.006 * deg};
  for (const core::ScannerModel model : test::all_models) {
    const core::Scanner scanner = test::scanner_of(model, true);
    const core::Calibration calibration = test::some_calibration();
    const core::Geodetic geodetic{47.9 * deg, 10.5 * deg, 1600.0};
    const core::Attitude attitude{0.05, 0.03, 2.0};
    const Vector3d speed(-30.0, 50.0, 1.0), rate(0.04, 0.02, -0.05);
    const Return record{0.3, model == core::ScannerModel::beam ? 0.1 : 0.0, 1000.0};
    const trajectory::Pose pose = test::pose_of(geodetic, attitude, speed, rate);
    const Matrix3d ned = ecef_R_ned_at(pose);
    Jacobian J;
    const ShotGeometry truth(scanner, calibration);
    const Vector3d point = truth.ecef_point(pose, record, J);
    const Vector3d ray =
        truth.body_R_scanner() * (truth.range(record.range) * truth.beam()(truth.angle(record.angle), record.forward).direction);
    const Vector3d beam = ned.transpose() * pose.ecef_R_body * ray;
    const Matrix3d C = covariance(ned_jacobian(J, pose), variances(sigma, place), beam, sigma.beam_divergence.value);

    Matrix3d sum = Matrix3d::Zero();
    for (int i = 0; i < draws; ++i) {
      const auto draw = [&](double s) { return s * normal(random); };
      core::Calibration c = calibration;
      c.roll.value += draw(sigma.roll.value);
      c.pitch.value += draw(sigma.pitch.value);
      c.heading.value += draw(sigma.heading.value);
      for (core::Metres& l : c.lever_arm_scanner) l.value += draw(sigma.lever_arm.value);
      c.range_offset.value += draw(sigma.range_offset.value);
      c.range_scale += draw(sigma.range_scale);
      c.scan_offset.value += draw(sigma.scan_offset.value);
      c.scan_scale += draw(sigma.scan_scale);
      const double dt = draw(sigma.latency.value) + draw(sigma.time.value);
      const core::Attitude a{attitude.roll + draw(place.roll), attitude.pitch + draw(place.pitch), attitude.heading + draw(place.heading)};
      trajectory::Pose p = test::pose_of(geodetic, a, speed, rate);
      p.position += dt * p.velocity + ned * Vector3d(draw(place.north), draw(place.east), draw(place.down));
      p.ecef_R_body = p.ecef_R_body * core::exp_so3(dt * rate);
      const Return r{record.angle + draw(sigma.scan_angle.value), record.forward, record.range + draw(sigma.range.value)};
      Vector3d e = ned.transpose() * (ShotGeometry(scanner, c).ecef_point(p, r) - point);
      // Pointing within the beam.
      const Vector3d u = beam.unitOrthogonal(), v = beam.normalized().cross(u);
      const double pointing = sigma.beam_divergence.value / 4.0 * beam.norm();
      e += draw(pointing) * u + draw(pointing) * v;
      sum += e * e.transpose();
    }
    sum /= draws;
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(std::sqrt(sum(k, k) / C(k, k)), low) << "model " << static_cast<int>(model) << " axis " << k;
      EXPECT_LT(std::sqrt(sum(k, k) / C(k, k)), high) << "model " << static_cast<int>(model) << " axis " << k;
    }
  }
}

// Returns of an independent simulator, with its true trajectory and calibration (truth/truth.json): what is left is its noise, 2 cm of
// range.
TEST(Georeference, TinySurveyWithItsTrueTrajectoryAndCalibration) {
  SWATH_SHARED_OR_SKIP(folder, "data/tiny_survey");
  const test::Records laser = test::npy(folder / "laser.npy", 30), truth = test::npy(folder / "truth" / "returns.npy", 77);
  ASSERT_EQ(laser.count(), 108430u);
  ASSERT_EQ(truth.count(), laser.count());
  core::Shots shots;
  for (size_t i = 0; i < laser.count(); ++i) {
    shots.time.push_back(laser.get<double>(i, 0));
    shots.angle.push_back(laser.get<double>(i, 8) * deg);
    shots.range.push_back(laser.get<double>(i, 16));
    shots.record.push_back(static_cast<std::uint32_t>(i));
  }
  core::Calibration c;
  c.roll = core::degrees(0.05);
  c.pitch = core::degrees(0.12);
  c.heading = core::degrees(-0.15);
  c.lever_arm_scanner = {core::Metres(0.185), core::Metres(-0.072), core::Metres(0.324)};
  c.range_offset = core::Metres(0.02);
  c.scan_scale = 1.0002;
  const trajectory::Trajectory flight(test::sbet(folder / "truth" / "sbet.out"));
  const Georeferencer g({}, c, {}, flight, utm(), Vector3d(613000.0, 5307000.0, 0.0));
  core::Block out;
  EXPECT_EQ(g.run(shots, out).georeferenced, laser.count());

  Vector3d sum = Vector3d::Zero();
  double squares = 0.0;
  for (size_t i = 0; i < out.size(); ++i) {
    ASSERT_EQ(out.record[i], i);
    const Vector3d known(truth.get<double>(i, 32), truth.get<double>(i, 40), truth.get<double>(i, 48));
    const Vector3d e = out.origin + Vector3d(out.x[i], out.y[i], out.z[i]) - known;
    sum += e;
    squares += e.squaredNorm();
  }
  const Vector3d mean = sum / static_cast<double>(out.size());
  const double rms = std::sqrt(squares / static_cast<double>(out.size()));
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(std::abs(mean[k]), 1e-3) << "axis " << k;
    RecordProperty("mean_um_" + std::to_string(k), static_cast<int>(1e6 * mean[k]));
  }
  EXPECT_LE(rms, 0.0210);
  RecordProperty("rms_um", static_cast<int>(1e6 * rms));
}

// Real returns in ECEF against their maker's UTM, and in the frame of their SBET: one scanner's beams lie in one plane of the body.
TEST(Georeference, LeewardBodyVectorsLieInAPlane) {
  SWATH_SHARED_OR_SKIP(folder, "data/als_leeward");
  const test::Las ecef = test::las(folder / "points_ecef.las");
  const trajectory::Trajectory flight(test::sbet(folder / "sbet.out"));
  std::vector<Vector3d> beams;
  Matrix3d sum = Matrix3d::Zero();
  for (size_t i = 0; i < ecef.records.count(); ++i) {
    const auto pose = flight.pose_at(ecef.time(i));
    ASSERT_TRUE(pose) << i;
    const Vector3d p(ecef.coordinate(i, 0), ecef.coordinate(i, 1), ecef.coordinate(i, 2));
    beams.push_back((pose->ecef_R_body.transpose() * (p - pose->position)).normalized());
    sum += beams.back() * beams.back().transpose();
  }
  ASSERT_EQ(beams.size(), 1325u);
  const Vector3d normal = Eigen::SelfAdjointEigenSolver<Matrix3d>(sum).eigenvectors().col(0);
  double squares = 0.0;
  for (const Vector3d& b : beams) squares += std::pow(std::asin(b.dot(normal)), 2);
  const double rms = std::sqrt(squares / static_cast<double>(beams.size()));
  EXPECT_LT(rms, 0.005 * deg);
  RecordProperty("rms_udeg", static_cast<int>(1e6 * rms / deg));
}

}  // namespace
}  // namespace swath::georef
