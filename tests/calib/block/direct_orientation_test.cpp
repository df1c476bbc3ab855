// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/direct_orientation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "calib/block/block_frame.h"
#include "core/error.h"
#include "core/geo/geodesy.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double latitude = 48.0 * core::degree, longitude = 10.5 * core::degree, height = 900.0;

/// North at 50 m/s with constant attitude, 20 Hz.
core::TrajectoryData straight(const core::Attitude& a, double north = 0.0, double east = 0.0, double down = 0.0) {
  core::TrajectoryData d;
  for (int k = 0; k < 100; ++k) {
    d.time.push_back(1000.0 + 0.05 * k);
    d.latitude.push_back(latitude + (2.5 * k + north) / core::meridian_radius(latitude));
    d.longitude.push_back(longitude + east / (core::prime_vertical_radius(latitude) * std::cos(latitude)));
    d.height.push_back(height - down);
    d.roll.push_back(a.roll), d.pitch.push_back(a.pitch), d.heading.push_back(a.heading);
    d.sigma_north.push_back(0.02f), d.sigma_east.push_back(0.03f), d.sigma_down.push_back(0.05f);
    d.sigma_roll.push_back(1e-4f), d.sigma_pitch.push_back(2e-4f), d.sigma_heading.push_back(4e-4f);
  }
  return d;
}

std::vector<Exposure> exposure(double time, double sigma = 0.0) { return {{"1", 0, 3, time, sigma, false}}; }

DirectImage oriented_at(const core::TrajectoryData& data, double time, const DirectCamera& c, double sigma = 0.0) {
  DirectFound found;
  return direct_orientation(trajectory::Trajectory(data), exposure(time, sigma), {c}, core::Crs("EPSG:32632"), found).at(0);
}

io::SurveyCamera stated_camera() {
  io::SurveyCamera c;
  c.mount = core::degrees(90.0);
  c.boresight = {core::degrees(0.3), core::degrees(-0.2), core::degrees(0.7)};
  c.lever_arm = {core::Metres(0.4), core::Metres(-0.2), core::Metres(1.5)};
  return c;
}

DirectCamera mounted() { return direct_camera(stated_camera(), "survey.toml"); }

TEST(DirectOrientation, SigmasOfTheMountingAreThoseOfTheSurvey) {
  io::SurveyCamera c = stated_camera();
  c.sigma.boresight = "0.1 deg", c.sigma.lever_arm = "2 cm";
  EXPECT_NEAR(direct_camera(c, "").sigma_boresight, 0.1 * core::degree, 1e-12);
  EXPECT_NEAR(direct_camera(c, "").sigma_lever_arm, 0.02, 1e-12);
  c.sigma.boresight = "free", c.sigma.lever_arm = "held";
  EXPECT_EQ(direct_camera(c, "").sigma_boresight + direct_camera(c, "").sigma_lever_arm, 0.0);
  c.sigma.lever_arm = "2";
  EXPECT_THROW(direct_camera(c, ""), core::Error);
}

TEST(DirectOrientation, PositionAndAxes) {
  const core::Attitude a{0.03, -0.02, 0.4};
  const DirectImage i = oriented_at(straight(a), 1002.5, mounted());
  EXPECT_EQ(i.strip, 3);
  EXPECT_NEAR(i.attitude.heading, a.heading, 1e-5);
  // By the way of the conventions: IMU, lever arm in the body, ECEF, map.
  const core::Geodetic at{latitude + 125.0 / core::meridian_radius(latitude), longitude, height};
  const Matrix3d ecef_R_body = core::ecef_R_ned(at.latitude, at.longitude) * core::matrix_of(a);
  const Vector3d centre = core::ecef_of(at) + ecef_R_body * Vector3d(0.4, -0.2, 1.5);
  EXPECT_LT((i.orientation.map - core::Transform(core::wgs84_ecef(), core::Crs("EPSG:32632"))(centre)).norm(), 1e-4);
  // The camera looks down, its upper edge forward: the image's y axis along the heading, east of the grid by the convergence.
  const Vector3d up_edge = i.orientation.grid_R_camera.col(1);
  EXPECT_NEAR(std::atan2(up_edge.x(), up_edge.y()), a.heading + core::degrees(0.7).value - 1.5 * core::degree * std::sin(latitude), 2e-3);
  EXPECT_GT(i.orientation.grid_R_camera(2, 2), 0.99);
  EXPECT_NEAR(i.orientation.grid_R_camera.determinant(), 1.0, 1e-12);
}

/// Change of an orientation: position on the grid, and rotation vector w about the camera's axes, camera_R = exp(w) camera_R0.
Eigen::Matrix<double, 6, 1> change(const DirectImage& from, const DirectImage& to) {
  Eigen::Matrix<double, 6, 1> out;
  out << to.orientation.map - from.orientation.map,
      core::log_so3(to.orientation.grid_R_camera.transpose() * from.orientation.grid_R_camera);
  return out;
}

TEST(DirectOrientation, CovarianceIsThatOfTheChanges) {
  const core::Attitude a{0.05, -0.04, 2.1};
  const DirectCamera o = mounted();
  const DirectImage here = oriented_at(straight(a), 1002.5, o, 1e-3);
  Eigen::Matrix<double, 6, 6> expected = Eigen::Matrix<double, 6, 6>::Zero();
  const auto add = [&](const Eigen::Matrix<double, 6, 1>& d, double step, double sigma) {
    const Eigen::Matrix<double, 6, 1> by = d / step * sigma;
    expected += by * by.transpose();
  };
  constexpr double metre = 0.5, angle = 1e-4, instant = 0.01;
  add(change(here, oriented_at(straight(a, metre), 1002.5, o)), metre, 0.02);
  add(change(here, oriented_at(straight(a, 0, metre), 1002.5, o)), metre, 0.03);
  add(change(here, oriented_at(straight(a, 0, 0, metre), 1002.5, o)), metre, 0.05);
  add(change(here, oriented_at(straight({a.roll + angle, a.pitch, a.heading}), 1002.5, o)), angle, 1e-4);
  add(change(here, oriented_at(straight({a.roll, a.pitch + angle, a.heading}), 1002.5, o)), angle, 2e-4);
  add(change(here, oriented_at(straight({a.roll, a.pitch, a.heading + angle}), 1002.5, o)), angle, 4e-4);
  add(change(here, oriented_at(straight(a), 1002.5 + instant, o)), instant, 1e-3);
  // The grid's scale is 0.9998 there, so 1e-3 of a variance; map coordinates round at 1e-9 m.
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c)
      EXPECT_NEAR(here.orientation.covariance(r, c), expected(r, c), 3e-3 * std::sqrt(expected(r, r) * expected(c, c))) << r << " " << c;
}

std::vector<Exposure> exposures(std::initializer_list<double> times, double sigma) {
  std::vector<Exposure> out;
  for (const double t : times) out.push_back({std::to_string(out.size() + 1), 0, 1, t, sigma, false});
  return out;
}

OrientationCorrelation correlation_of(const std::vector<DirectImage>& images, const trajectory::Trajectory& trajectory,
                                      const DirectOptions& o) {
  OrientationCorrelation out;
  direct_correlation(images, trajectory, o, [&](const CovariancePair& p) { out.pairs.push_back(p); });
  return out;
}

/// Of one image: what its covariance has, in the body's axes, without boresight and lever arm. Of two: what decays with time.
TEST(DirectOrientation, CorrelationOfImages) {
  const trajectory::Trajectory trajectory(straight({0.05, -0.04, 2.1}));
  DirectCamera camera = mounted();
  camera.sigma_lever_arm = 0.3;
  DirectOptions o;
  o.errors.position_correlation = o.errors.roll_correlation = o.errors.pitch_correlation = o.errors.heading_correlation =
      core::Seconds(2.0);
  DirectFound found;
  const auto images = direct_orientation(trajectory, exposures({1001.0, 1002.0, 1003.5}, 1e-3), {camera}, core::Crs("EPSG:32632"), found);
  const OrientationCorrelation all = correlation_of(images, trajectory, o);
  ASSERT_EQ(all.pairs.size(), 6u);
  PoseCovariance turn = PoseCovariance::Identity();  // to the camera's axes
  turn.bottomRightCorner<3, 3>() = camera.body_R_camera.transpose();
  const auto expect_near = [](const PoseCovariance& a, const PoseCovariance& b, const PoseCovariance& size) {
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) EXPECT_NEAR(a(r, c), b(r, c), 1e-6 * std::sqrt(size(r, r) * size(c, c))) << r << " " << c;
  };
  PoseCovariance arm = PoseCovariance::Zero();
  arm.topLeftCorner<3, 3>() = 0.09 * Matrix3d::Identity();
  for (const CovariancePair& p : all.pairs)
    if (p.image == p.other)
      expect_near(turn * p.value * turn.transpose() + arm, images[p.image].orientation.covariance, images[0].orientation.covariance);
  const CovariancePair &own = all.pairs[2], &before = all.pairs[1];
  ASSERT_EQ(before.image, 1u);
  ASSERT_EQ(before.other, 0u);
  const PoseCovariance expected = std::exp(-0.5) * (own.value - images[1].errors.of_time * images[1].errors.of_time.transpose());
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c)
      EXPECT_NEAR(before.value(r, c), expected(r, c), 1e-4 * std::sqrt(own.value(r, r) * own.value(c, c))) << r << " " << c;
  o.correlated_images = 1;
  const OrientationCorrelation few = correlation_of(images, trajectory, o);
  ASSERT_EQ(few.pairs.size(), 5u);
  EXPECT_EQ(few.pairs[3].other, 1u);
  expect_near(few.pairs[3].value, all.pairs[4].value, own.value);
}

/// Two cameras with one trigger have all errors in common, that of its time as well: their difference is that of the rig alone.
TEST(DirectOrientation, CamerasOfOneEventShareItsTime) {
  const trajectory::Trajectory trajectory(straight({0.05, -0.04, 2.1}));
  std::vector<Exposure> e{{"a", 0, 1, 1001.0, 0.01, false, 7}, {"b", 1, 1, 1001.0, 0.01, false, 7}, {"c", 0, 1, 1001.0, 0.01, false, 8}};
  DirectFound found;
  const auto images = direct_orientation(trajectory, e, {mounted(), mounted()}, core::Crs("EPSG:32632"), found);
  const OrientationCorrelation all = correlation_of(images, trajectory, {});
  ASSERT_EQ(all.pairs.size(), 6u);
  const PoseCovariance &own = all.pairs[0].value, &rig = all.pairs[1].value, &other = all.pairs[4].value;
  EXPECT_LT((rig - own).norm(), 1e-6 * own.norm());
  EXPECT_LT((other - (own - images[0].errors.of_time * images[0].errors.of_time.transpose())).norm(), 1e-6 * own.norm());
  EXPECT_GT((other - own).norm(), 0.1 * own.norm()) << "0.5 m of 0.02 m";
}

/// Images in many windows have the same covariances as in one.
TEST(DirectOrientation, CorrelationOfManyImages) {
  const trajectory::Trajectory trajectory(straight({0.05, -0.04, 2.1}));
  std::vector<Exposure> e;
  for (int k = 0; k < 120; ++k) e.push_back({std::to_string(k), 0, 1, 1000.1 + 0.04 * k, 0.0, false});
  DirectOptions o;
  DirectFound found;
  const auto images = direct_orientation(trajectory, e, {mounted()}, core::Crs("EPSG:32632"), found);
  o.correlated_images = 7;
  const OrientationCorrelation windows = correlation_of(images, trajectory, o);
  o.correlated_images = 1000;
  const OrientationCorrelation one = correlation_of(images, trajectory, o);
  EXPECT_EQ(one.pairs.size(), 120u * 121u / 2u);
  ASSERT_EQ(windows.pairs.size(), 120u * 8u - 28u);
  for (const CovariancePair& p : windows.pairs) {
    const CovariancePair& same = one.pairs[p.image * (p.image + 1u) / 2u + p.other];
    EXPECT_LT((p.value - same.value).norm(), 1e-9 * same.value.norm());
  }
}

TEST(DirectOrientation, TheTableIsWhatABlockReads) {
  DirectFound found;
  std::vector<Exposure> e = exposure(1002.5);
  e.push_back({"2", 0, 3, 2000.0, 0.0, true});
  const trajectory::Trajectory flown(straight({0, 0, 1}));
  const std::vector<DirectCamera> cameras{{"left"}};
  const auto images = direct_orientation(flown, e, cameras, core::Crs("EPSG:32632"), found);
  EXPECT_EQ(found.images, 1u);
  EXPECT_EQ(found.outside, 1u);
  EXPECT_EQ(found.exact, 1u);  // its sigmas are too small by what the time's would add
  EXPECT_NEAR(found.height, 0.05, 1e-6);
  const std::string table = direct_images_csv(images, cameras);
  EXPECT_TRUE(table.starts_with("name,camera,strip,time,x,y,z,sigma_h,sigma_v,roll,pitch,heading\n1,left,3,1002.500000000,")) << table;
  const auto degrees = direct_orientation(flown, e, cameras, core::Crs("EPSG:4326"), found);
  const std::string row = direct_images_csv(degrees, cameras);
  char place[60];
  std::snprintf(place, sizeof place, ",%.13f,%.13f,", degrees[0].orientation.map.x(), degrees[0].orientation.map.y());
  EXPECT_NE(row.find(place), std::string::npos) << row;
  std::snprintf(place, sizeof place, ",%.7f,%.7f,", images[0].orientation.map.y(), images[0].orientation.map.z());
  EXPECT_NE(table.find(place), std::string::npos) << table;
  e.erase(e.begin());
  EXPECT_THROW(direct_orientation(flown, e, cameras, core::Crs("EPSG:32632"), found), core::Error);
}

}  // namespace
}  // namespace swath::calib
