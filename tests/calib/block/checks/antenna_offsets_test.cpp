// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/antenna_offsets.h"

#include <gtest/gtest.h>

#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

const Eigen::Vector3d arm(1.2, -0.9, -2.1);  // body axes, m

/// A block at its true values whose stations are those of an antenna, to 0.1 m.
ImageBlock made(const Eigen::Vector3d& stated) {
  ImageBlock b = test::make_block(test::Making()).truth;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (ImageStation& s : b.stations) {
    const BlockImage& i = b.images[s.image];
    const Eigen::Vector3d noise(0.1 * normal(random), 0.1 * normal(random), 0.1 * normal(random));
    s.position = i.position + i.camera_R_local.transpose() * b.cameras[i.camera].body_R_camera.transpose() * arm + noise;
    s.covariance = 0.01 * Eigen::Matrix3d::Identity();
  }
  for (BlockCamera& c : b.cameras) c.antenna = c.body_R_camera.transpose() * stated;
  return b;
}

std::string finding(const ImageBlock& b) {
  const std::vector<std::string> found = antenna_findings(b);
  return found.empty() ? "" : found.front();
}

TEST(AntennaOffsets, ARightAntennaIsNotNamed) { EXPECT_EQ(finding(made(arm)), ""); }

TEST(AntennaOffsets, SignsAreNamed) {
  const std::string down = finding(made({arm.x(), arm.y(), -arm.z()}));
  EXPECT_NE(down.find("the opposite sign of down explains it"), std::string::npos) << down;
  EXPECT_EQ(down.find("check its axes"), std::string::npos) << down;
  const std::string all = finding(made(-arm));
  EXPECT_NE(all.find(" m right, -4."), std::string::npos) << all;
  EXPECT_NE(all.find("the opposite sign of forward, right, down explains it"), std::string::npos) << all;
}

TEST(AntennaOffsets, AnotherPlaceIsNamedWithoutASign) {
  const std::string found = finding(made({0.2, arm.y(), arm.z()}));
  EXPECT_NE(found.find("check its axes"), std::string::npos) << found;
  EXPECT_EQ(found.find("other sign"), std::string::npos) << found;
}

TEST(AntennaOffsets, AFreeAntennaAndADriftTakeItUp) {
  ImageBlock b = made(-arm);
  b.drift_sets = DriftSets::strip;
  EXPECT_EQ(finding(b), "");
  b.drift_sets = DriftSets::none;
  b.cameras[0].antenna_sigma.setConstant(free_value);
  EXPECT_EQ(finding(b), "");
}

}  // namespace
}  // namespace swath::calib
