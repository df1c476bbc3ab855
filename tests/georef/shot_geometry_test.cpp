// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/shot_geometry.h"

#include <gtest/gtest.h>

#include <random>

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

// Everything that a point depends on, to be perturbed.
struct Setting {
  core::Scanner scanner;
  core::Calibration calibration;
  core::Geodetic place{47.9 * deg, 10.5 * deg, 1600.0};
  core::Attitude attitude;
  Vector3d speed{55.0, -20.0, 1.0};
  Vector3d rate{0.05, -0.03, 0.02};
  Return record{0.2, 0.0, 1000.0};
};

// The point with one parameter changed by d. Position and time move as the Jacobian says: metres in NED, and along velocity and rate.
Vector3d moved(const Setting& given, int parameter, double d) {
  Setting s = given;
  core::Calibration& c = s.calibration;
  Vector3d shift = Vector3d::Zero();
  double time = 0.0;
  switch (parameter) {
    case boresight_roll:
      c.roll.value += d;
      break;
    case boresight_pitch:
      c.pitch.value += d;
      break;
    case boresight_heading:
      c.heading.value += d;
      break;
    case lever_forward:
    case lever_right:
    case lever_down:
      c.lever_arm_scanner[static_cast<size_t>(parameter - lever_forward)].value += d;
      break;
    case range_offset:
      c.range_offset.value += d;
      break;
    case range_scale:
      c.range_scale += d;
      break;
    case scan_offset:
      c.scan_offset.value += d;
      break;
    case scan_scale:
      c.scan_scale += d;
      break;
    case latency:
    case record_time:
      time = d;
      break;
    case position_north:
    case position_east:
    case position_down:
      shift[parameter - position_north] = d;
      break;
    case attitude_roll:
      s.attitude.roll += d;
      break;
    case attitude_pitch:
      s.attitude.pitch += d;
      break;
    case attitude_heading:
      s.attitude.heading += d;
      break;
    case record_range:
      s.record.range += d;
      break;
    case record_angle:
      s.record.angle += d;
      break;
    default:
      break;
  }
  trajectory::Pose pose = test::pose_of(s.place, s.attitude, s.speed, s.rate);
  // Moved without turning the nadir: the shift is applied to the result.
  const Matrix3d ned = ecef_R_ned_at(pose);
  pose.ecef_R_body = pose.ecef_R_body * core::exp_so3(time * s.rate);
  return ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record) + ned * shift + time * pose.velocity;
}

void expect_derivatives(const Setting& s, const std::string& what) {
  const trajectory::Pose pose = test::pose_of(s.place, s.attitude, s.speed, s.rate);
  Jacobian J;
  const Vector3d p = ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record, J);
  EXPECT_LT((p - ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record)).norm(), 1e-8);
  for (int k = 0; k < parameter_count; ++k) {
    // Steps that move the point by about a metre at most: central differences then err by 1e-9 / h and h^2.
    const bool metres = (k >= lever_forward && k <= range_offset) || (k >= position_north && k <= position_down) || k == record_range;
    const double h = metres ? 0.5 : 1e-4;
    const Vector3d difference = (moved(s, k, h) - moved(s, k, -h)) / (2.0 * h);
    const double size = std::max(1.0, difference.norm());
    EXPECT_LT((J.col(k) - difference).norm(), 2e-8 * size + 2e-9 / h) << what << ", parameter " << k;
  }
}

TEST(ShotGeometry, JacobianIsTheCentralDifference) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const core::ScannerModel model : test::all_models)
    for (const bool air : {false, true}) {
      Setting s;
      s.scanner = test::scanner_of(model, air);
      const std::string name = "model " + std::to_string(static_cast<int>(model)) + (air ? " in air" : "");
      s.attitude = {};
      s.record.angle = 0.0;
      expect_derivatives(s, name + " at zero");
      s.attitude = {1e-7, -1e-7, 1e-7};
      s.record.angle = 1e-7;
      s.calibration.roll.value = s.calibration.pitch.value = s.calibration.heading.value = -1e-7;
      expect_derivatives(s, name + " near zero");
      for (int i = 0; i < 20; ++i) {
        s.calibration = test::some_calibration();
        s.calibration.roll = core::degrees(5.0 * unit(random));
        s.calibration.pitch = core::degrees(5.0 * unit(random));
        s.calibration.heading = core::degrees(180.0 * unit(random));
        s.attitude = {20.0 * deg * unit(random), 15.0 * deg * unit(random), 180.0 * deg * unit(random)};
        s.record = {0.5 * unit(random), 0.2 * unit(random), 1000.0 + 500.0 * unit(random)};
        expect_derivatives(s, name + " at random " + std::to_string(i));
      }
    }
}

TEST(ShotGeometry, TheEquationByHand) {
  // Level, heading east, boresight none: 30 deg to starboard is south.
  Setting s;
  s.scanner = test::scanner_of(core::ScannerModel::mirror, false);
  s.calibration.lever_arm_scanner = {core::Metres(1.0), core::Metres(2.0), core::Metres(3.0)};
  s.calibration.range_offset = core::Metres(4.0);
  s.calibration.range_scale = 2.0;
  s.calibration.scan_offset = core::degrees(10.0);
  s.calibration.scan_scale = 0.5;
  s.attitude = {0.0, 0.0, 90.0 * deg};
  s.record = {40.0 * deg, 0.0, 498.0};
  const trajectory::Pose pose = test::pose_of(s.place, s.attitude, s.speed, s.rate);
  const Vector3d ned =
      ecef_R_ned_at(pose).transpose() * (ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record) - pose.position);
  EXPECT_LT((ned - Vector3d(-2.0 - 500.0, 1.0, 3.0 + 1000.0 * std::sqrt(0.75))).norm(), 1e-8);
}

TEST(ShotGeometry, SmallBoresightMovesThePointAsThePaperSays) {
  // P4 eqs. 5 to 8 (x along, y across, z down): roll moves across by -z dr, pitch along by z dp, heading along by -y dh.
  Setting s;
  s.scanner = test::scanner_of(core::ScannerModel::mirror, false);
  s.record = {0.3, 0.0, 1000.0};
  const trajectory::Pose pose = test::pose_of(s.place, {}, s.speed, s.rate);
  Jacobian J;
  ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record, J);
  const Jacobian ned = ned_jacobian(J, pose);
  const double y = 1000.0 * std::sin(0.3), z = 1000.0 * std::cos(0.3);
  EXPECT_LT((ned.col(attitude_roll) - Vector3d(0.0, -z, y)).norm(), 1e-9);
  EXPECT_LT((ned.col(attitude_pitch) - Vector3d(z, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((ned.col(attitude_heading) - Vector3d(-y, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((ned.col(boresight_roll) - ned.col(attitude_roll)).norm(), 1e-9);
}

TEST(ShotGeometry, CovarianceOfKnownParts) {
  Setting s;
  s.scanner = test::scanner_of(core::ScannerModel::mirror, false);
  s.record = {0.0, 0.0, 1000.0};
  const trajectory::Pose pose = test::pose_of(s.place, {}, Vector3d::Zero(), Vector3d::Zero());
  Jacobian J;
  ShotGeometry(s.scanner, s.calibration).ecef_point(pose, s.record, J);
  core::SensorSigma sigma;
  sigma.roll = sigma.pitch = sigma.heading = core::Radians(0.0);
  sigma.lever_arm = core::Metres(0.0);
  sigma.scan_angle = core::Radians(1e-4);
  sigma.range = core::Metres(0.02);
  const Matrix3d C = covariance(ned_jacobian(J, pose), variances(sigma, {}), Vector3d(0.0, 0.0, 1000.0), 4e-4);
  // Nadir beam: range is height; scan angle 0.1 m across; a quarter of the divergence 0.1 m along and across.
  EXPECT_NEAR(C(0, 0), 0.01, 1e-9);
  EXPECT_NEAR(C(1, 1), 0.02, 1e-9);
  EXPECT_NEAR(C(2, 2), 0.0004, 1e-9);
}

}  // namespace
}  // namespace swath::georef
