// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/image_table.h"

#include <gtest/gtest.h>

#include "core/config/units.h"
#include "core/error.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

class ImageTables : public testing::Test {
 protected:
  ImageTables() {
    config.cameras.resize(2);
    config.cameras[0].name = "left", config.cameras[1].name = "right";
    config.images.file = folder / "images.csv";
    config.images.angles = ImageAngles::roll_pitch_heading;
  }
  std::string fault_of(const std::string& images) {
    test::write_bytes(folder / "images.csv", images);
    try {
      read_image_table(config);
    } catch (const core::Error& e) {
      return e.text();
    }
    return {};
  }
  const test::TemporaryFolder folder;
  BlockConfig config;
};

TEST_F(ImageTables, RowsHaveTheirSigmasOrThoseOfTheConfig) {
  test::write_bytes(folder / "images.csv", "name,camera,strip,time,x,y,z,sigma_h,roll,pitch,heading\na,right,2,10.5,1,2,3,0.02,1,-2,90\n");
  const auto rows = read_image_table(config);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].image.camera, 1u);
  EXPECT_EQ(rows[0].image.strip, 2);
  EXPECT_EQ(rows[0].map, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(rows[0].sigma_h, 0.02);
  EXPECT_EQ(rows[0].sigma_v, config.images.sigma_station_v.value);
  EXPECT_NEAR(rows[0].angles[1], -2.0 * core::degree, 1e-15);
}

TEST_F(ImageTables, MistakesAreNamedWithTheirLine) {
  const std::string head = "name,camera,strip,time,x,y,z,roll,pitch,heading\n", row = "a,left,1,10,1,2,3,0,0,0\n";
  EXPECT_EQ(fault_of(head + row), "");
  EXPECT_NE(fault_of(head + row + row).find("image a is there twice, first in " + (folder / "images.csv").string() + ":2"),
            std::string::npos);
  EXPECT_NE(fault_of(head + "a,middle,1,10,1,2,3,0,0,0\n").find("camera middle is not in the config"), std::string::npos);
  EXPECT_NE(fault_of("name,strip,time,x,y,z,roll,pitch,heading\na,1,10,1,2,3,0,0,0\n").find("several cameras"), std::string::npos);
  config.images.angles = ImageAngles::omega_phi_kappa;
  EXPECT_NE(fault_of(head + row).find("omega"), std::string::npos);
}

TEST_F(ImageTables, ControlOfSeveralFilesKeepsItsKindAndUse) {
  test::write_bytes(folder / "full.csv", "name,x,y,z,sigma_v\np,1,2,3,0.5\n");
  test::write_bytes(folder / "heights.csv", "name,x,y,z\nq,4,5,6\n");
  config.control.resize(2);
  config.control[0].file = folder / "full.csv";
  config.control[1].file = folder / "heights.csv";
  config.control[1].kind = io::ControlKind::z, config.control[1].use = io::ControlUse::check;
  const auto points = read_control_tables(config);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].sigma_v, 0.5);
  EXPECT_EQ(points[0].sigma_h, config.control[0].sigma_horizontal.value);
  EXPECT_TRUE(points[1].check && points[1].kind == io::ControlKind::z);
  EXPECT_TRUE(points[1].place.ends_with("heights.csv:2"));
}

}  // namespace
}  // namespace swath::calib
