// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/geolocation_files.h"

#include <gtest/gtest.h>

#include "calib/block/block_config.h"
#include "calib/block/direct_orientation.h"
#include "calib/block/orientation_table.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

using core::degree;

/// Columns: the image's right, upper edge and back in north, east, down.
Eigen::Matrix3d camera(const Eigen::Vector3d& right, const Eigen::Vector3d& upper, const Eigen::Vector3d& back) {
  Eigen::Matrix3d R;
  R << right, upper, back;
  return R;
}

TEST(GeolocationFiles, AnglesAreThoseOfTheUpperEdge) {
  const Eigen::Vector3d north(1, 0, 0), east(0, 1, 0), down(0, 0, 1);
  const core::Attitude level = upper_edge_attitude(camera(east, north, -down));
  EXPECT_NEAR(level.roll, 0.0, 1e-12);
  EXPECT_NEAR(level.pitch, 0.0, 1e-12);
  EXPECT_NEAR(level.heading, 0.0, 1e-12);
  EXPECT_NEAR(upper_edge_attitude(camera(-north, east, -down)).heading, 90.0 * degree, 1e-12);
  // Looking north and 10 deg above level ground's horizon less 90: pitch 80, the upper edge up.
  const double p = 80.0 * degree;
  const Eigen::Vector3d upper = std::cos(p) * north - std::sin(p) * down, view = std::cos(p) * down + std::sin(p) * north;
  EXPECT_NEAR(upper_edge_attitude(camera(east, upper, -view)).pitch, p, 1e-12);
}

TEST(GeolocationFiles, TheyAreThoseOfABodyWithMount90) {
  // What `swath block` reads as roll_pitch_heading with mount = "90 deg".
  const core::Attitude body{2.0 * degree, -3.0 * degree, 200.0 * degree};
  const core::Attitude found = upper_edge_attitude(core::matrix_of(body) * camera_mounting(core::degrees(90.0), {}));
  EXPECT_NEAR(found.roll, body.roll, 1e-12);
  EXPECT_NEAR(found.pitch, body.pitch, 1e-12);
  EXPECT_NEAR(std::remainder(found.heading - body.heading, 2.0 * core::pi), 0.0, 1e-12);
}

TEST(GeolocationFiles, Lines) {
  const std::vector<Geolocation> images{
      {"a.jpg", {500000.12342, 5400000.5, 900.25}, {0.5 * degree, -1.0 * degree, 90.0 * degree}, 0.02, 0.03}};
  EXPECT_EQ(geo_text("EPSG:25832", images),
            "EPSG:25832\na.jpg 500000.1234 5400000.5000 900.2500 90.00000 -1.00000 0.50000 0.0200 0.0300\n");
  EXPECT_EQ(geo_text("EPSG:25832+ellipsoidal", {}), "EPSG:25832\n");
  EXPECT_EQ(geo_text("+proj=utm +zone=32", {}), "+proj=utm +zone=32\n");
  EXPECT_EQ(geolocation_csv("EPSG:25832", images, false),
            "#imagename,easting,northing,z,yaw,pitch,roll,accuracy_horizontal,accuracy_vertical (EPSG:25832)\n"
            "a.jpg,500000.1234,5400000.5000,900.2500,90.00000,-1.00000,0.50000,0.0200,0.0300\n");
  std::vector<Geolocation> named = images;
  named[0].image = "a, 2.jpg";
  EXPECT_NE(geolocation_csv("EPSG:25832", named, false).find("\n\"a, 2.jpg\",500000.1234,"), std::string::npos);
  EXPECT_TRUE(orientation_line("a, 2.jpg", "left", 1, {}).starts_with("\"a, 2.jpg\",left,1,"));
  const std::vector<Geolocation> place{{"b", {9.1, 48.7, 400.0}, {0.0, 0.0, 0.0}, 0.1, 0.1}};
  EXPECT_NE(geolocation_csv("EPSG:4979", place, true).find("b,48.7000000000,9.1000000000,400.0000,"), std::string::npos);
  EXPECT_NE(geo_text("EPSG:4979", place).find("b 9.1000000000 48.7000000000 "), std::string::npos);
}

}  // namespace
}  // namespace swath::calib
