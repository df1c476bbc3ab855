// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/joint_covariance.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/calib/block/imagery/made_photos.h"
#include "tests/world/support.h"

namespace swath::calib::test {
namespace {

JointCovariance made() {
  JointCovariance out;
  CameraCovariance camera = CameraCovariance::Zero();
  camera.topLeftCorner<3, 3>() << 4e-6, 1e-7, -2e-7, 1e-7, 9e-6, 3e-8, -2e-7, 3e-8, 1e-6;
  out.cameras["left, wide"] = camera;
  PoseByCamera pose = PoseByCamera::Zero();
  pose(2, 0) = -1.25e-4, pose(4, 1) = 3.5e-7;
  out.images["DSC_1.jpg"] = pose;
  return out;
}

TEST(JointCovariance, WhatIsWrittenReadsBack) {
  const swath::test::TemporaryFolder folder;
  const auto file = folder.path() / "a.csv";
  swath::test::write_bytes(file, joint_covariance_csv("EPSG:25832", made()));
  const JointCovariance back = read_joint_covariance(file);
  EXPECT_TRUE(back.cameras.at("left, wide").isApprox(made().cameras.at("left, wide"), 1e-7));
  EXPECT_TRUE(back.images.at("DSC_1.jpg").isApprox(made().images.at("DSC_1.jpg"), 1e-7));
}

TEST(JointCovariance, DamagedFilesAreNamed) {
  const swath::test::TemporaryFolder folder;
  const auto file = folder.path() / "a.csv";
  const std::string text = joint_covariance_csv("EPSG:25832", made());
  swath::test::write_bytes(file, text.substr(0, text.rfind("image,")));
  EXPECT_NE(message_of([&] { read_joint_covariance(file); }).find("rows of DSC_1.jpg are missing"), std::string::npos);
  std::string other = text;
  other.replace(other.find(",about_x,"), 9, ",around,");
  swath::test::write_bytes(file, other);
  EXPECT_NE(message_of([&] { read_joint_covariance(file); }).find("'around' is not a component"), std::string::npos);
  other = text;
  other.replace(other.find("\nimage,"), 7, "\nphoto,");
  swath::test::write_bytes(file, other);
  EXPECT_NE(message_of([&] { read_joint_covariance(file); }).find("'photo' is neither camera nor image"), std::string::npos);
}

}  // namespace
}  // namespace swath::calib::test
