// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_config.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/text/value_file.h"

namespace swath::calib {
namespace {

BlockConfig read(const std::string& camera, const std::string& points = "sigma = \"3 um\"") {
  return read_block_config("a/b.toml", io::parse_toml("crs = \"local\"\n[[camera]]\nname = \"C\"\n" + camera +
                                                          "\n[[image_points]]\nfile = \"p.csv\"\n" + points + "\n",
                                                      "b.toml"));
}

std::string fault_of(const std::string& camera, const std::string& points = "sigma = \"3 um\"") {
  try {
    camera_of(read(camera, points).cameras[0], "b.toml");
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(BlockConfig, ACameraWithItsSigmas) {
  const BlockConfig c = read(
      "f = \"100.5 mm\"\nx0 = \"12 um\"\nk1 = -2e-8\ndistortion = \"measured\"\nmount = \"90 deg\"\nantenna = [\"1 m\", \"2 m\", \"-3 "
      "m\"]\n"
      "sigma = { f = \"free\", x0 = \"0.005 mm\", k1 = \"1e-9\", boresight = \"0.1 deg\" }");
  EXPECT_EQ(c.image_points[0].file, "a/p.csv");
  const BlockCamera k = camera_of(c.cameras[0], "b.toml");
  EXPECT_DOUBLE_EQ(k.value[0], 100.5);
  EXPECT_NEAR(k.value[1], 0.012, 1e-15);
  EXPECT_EQ(k.sigma[0], free_value);
  EXPECT_NEAR(k.sigma[1], 0.005, 1e-15);
  EXPECT_EQ(k.sigma[2], held_value);
  EXPECT_EQ(k.sigma[3], 1e-9);
  EXPECT_NEAR(k.boresight_sigma.x(), 0.1 * core::degree, 1e-15);
  EXPECT_EQ(k.distortion, DistortionAt::measured);
  // The image's x axis is to the right of the flight, its y axis forward, and it looks down.
  EXPECT_LT((k.body_R_camera.col(0) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((k.body_R_camera.col(1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((k.body_R_camera * k.antenna - Eigen::Vector3d(1, 2, -3)).norm(), 1e-12);
}

TEST(BlockConfig, Faults) {
  EXPECT_NE(fault_of("f = \"50 mm\"\nsigma = { f = \"free\", k1 = \"free\" }").find("distortion = \"ideal\""), std::string::npos);
  EXPECT_NE(fault_of("f = \"50 mm\"\nsigma = { f = \"0.01\" }").find("camera.sigma.f"), std::string::npos);
  EXPECT_NE(fault_of("f = \"50 mm\"\nsigma = { k2 = \"-1\" }").find("not above 0"), std::string::npos);
  EXPECT_NE(fault_of("f = \"50 mm\"", "").find("sigma of the image points is not stated"), std::string::npos);
  EXPECT_NE(fault_of("f = \"50 mm\"", "sigma = \"3 um\"\n[images]\nangles = \"omega_phi_kappa\"").find("north"), std::string::npos);
  EXPECT_NE(fault_of("focal = 3").find("focal"), std::string::npos);
  const std::string without = fault_of("x0 = \"12 um\"");  // any default would be a guess
  EXPECT_NE(without.find("camera[1].f"), std::string::npos) << without;
  EXPECT_NE(without.find("principal distance of the camera is not stated"), std::string::npos) << without;
}

}  // namespace
}  // namespace swath::calib
