// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_start.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

TEST(BlockStart, PosesFollowTheStripsAndPointsTheirRays) {
  test::Making m;
  test::MadeBlock b = test::make_block(m);
  for (size_t i = 0; i < b.given.images.size(); ++i) {
    const Eigen::Matrix3d turn = b.given.images[i].camera_R_local * b.truth.images[i].camera_R_local.transpose();
    EXPECT_LT(core::log_so3(turn).norm(), 0.1);  // attitudes of 0.02 rad about each axis, and crab
  }
  // With the true poses intersection gives the points, but for noise of 0.01 mm: 0.3 m on the ground.
  b.given.images = b.truth.images;
  b.given.control.clear();
  EXPECT_EQ(intersect_points(b.given), 0u);
  for (size_t p = 0; p < b.given.points.size(); ++p) EXPECT_LT((b.given.points[p].position - b.truth.points[p].position).norm(), 4.0);
}

TEST(BlockStart, LevelImagesTurnUntilTheirRaysMeet) {
  test::Making m;
  m.tilt = 0.1;
  test::MadeBlock b = test::make_block(m);
  const auto off = [&] {
    double sum = 0.0;
    for (size_t i = 0; i < b.given.images.size(); ++i) {
      const Eigen::Matrix3d turn = b.given.images[i].camera_R_local * b.truth.images[i].camera_R_local.transpose();
      sum += core::log_so3(turn).squaredNorm() / static_cast<double>(b.given.images.size());
    }
    return std::sqrt(sum);
  };
  const double level = off();
  EXPECT_GT(level, 0.12);
  turn_level_images(b.given);
  EXPECT_LT(off(), level / 4.0);
  for (size_t p = 0; p < b.given.points.size(); ++p)  // none behind an image or at infinity: images are at 4,500 m
    EXPECT_LT((b.given.points[p].position - b.truth.points[p].position).norm(), 1000.0) << p;
}

TEST(BlockStart, ObservedAttitudesAndTheLeverArmAreUsed) {
  test::Making m;
  m.attitudes = true;
  m.attitude_sigma = 1e-9;
  test::MadeBlock b = test::make_block(m);
  b.given.cameras[0] = b.truth.cameras[0];
  b.given.cameras[0].antenna = {0.4, -0.2, 1.0};
  for (ImageStation& s : b.given.stations)
    s.position = b.truth.images[s.image].position + b.truth.images[s.image].camera_R_local.transpose() * b.given.cameras[0].antenna;
  start_poses(b.given);
  for (size_t i = 0; i < b.given.images.size(); ++i) EXPECT_LT((b.given.images[i].position - b.truth.images[i].position).norm(), 1e-6);
}

TEST(BlockStart, WhatIsMissingIsNamed) {
  test::MadeBlock b = test::make_block({});
  b.given.images[2].name = "P17";
  std::vector<ImageStation> kept;
  for (const ImageStation& s : b.given.stations)
    if (s.image != 2) kept.push_back(s);
  b.given.stations = kept;
  try {
    start_poses(b.given);
    FAIL() << "an image without station was started";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("P17"), std::string::npos);
  }
  b = test::make_block({});
  b.given.images[0].strip = 99;
  EXPECT_THROW(start_poses(b.given), core::Error);
  b = test::make_block({});
  b.given.images[0].name = "P3", b.given.images[1].name = "P4";
  b.given.stations[1].position = b.given.stations[0].position;
  try {
    start_poses(b.given);
    FAIL() << "two images on one place were started";
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("images P3 and P4 of strip"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::calib
