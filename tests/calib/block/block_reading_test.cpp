// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_reading.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

std::string fault_of(const std::string& file) {
  try {
    read_block(test::read_made(file), file);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(BlockReading, FilesGiveTheBlockThatWasWritten) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const ReadBlock read = read_block(test::read_made(file), file);
  ASSERT_EQ(read.block.images.size(), m.block.images.size());
  ASSERT_EQ(read.block.rays.size(), m.block.rays.size());
  ASSERT_EQ(read.block.control.size(), m.block.control.size());
  EXPECT_EQ(read.started_from, "stations and the directions of the strips");
  for (size_t r = 0; r < m.block.rays.size(); ++r) {
    EXPECT_NEAR(read.block.rays[r].y, m.block.rays[r].y, 1e-12);
    EXPECT_NEAR(read.block.rays[r].sigma, 0.01, 1e-15);
  }
  size_t heights = 0;
  for (const BlockControl& c : read.block.control) heights += !c.known[0];
  EXPECT_GT(heights, 0u);
  // Images start level and along their strip: within the attitudes of the made block.
  for (size_t i = 0; i < m.block.images.size(); ++i)
    EXPECT_LT(core::log_so3(read.block.images[i].camera_R_local * m.block.images[i].camera_R_local.transpose()).norm(), 0.2);
}

TEST(BlockReading, AnglesOfEveryKindAreTheSameAttitude) {
  for (const char* kind : {"roll_pitch_heading", "omega_phi_kappa", "phi_omega_kappa"}) {
    const test::TemporaryFolder folder;
    test::MadeFiles m;
    m.block = test::make_block(test::small_making()).given;
    m.write_angles = true;
    m.angles = m.stated_angles = kind;
    m.angle_use = "observed";
    const std::string file = test::write_made(m, folder.path());
    const ReadBlock read = read_block(test::read_made(file), file);
    ASSERT_EQ(read.block.attitudes.size(), m.block.attitudes.size());
    for (size_t i = 0; i < read.block.attitudes.size(); ++i)
      EXPECT_LT((read.block.attitudes[i].local_R_body - m.block.attitudes[i].local_R_body).norm(), 1e-12) << kind;
  }
}

TEST(BlockReading, WhatDoesNotFitTogetherIsNamed) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const std::string points = swath::test::read_bytes(folder.path() / "points.csv"),
                    images = swath::test::read_bytes(folder.path() / "images.csv"),
                    control = swath::test::read_bytes(folder.path() / "control.csv");
  const auto changed = [&](const char* name, const std::string& text) {
    swath::test::write_bytes(folder.path() / name, text);
    const std::string fault = fault_of(file);
    swath::test::write_bytes(folder.path() / "points.csv", points);
    swath::test::write_bytes(folder.path() / "images.csv", images);
    swath::test::write_bytes(folder.path() / "control.csv", control);
    return fault;
  };
  const std::string last = points.substr(points.rfind('\n', points.size() - 2) + 1);
  EXPECT_NE(changed("points.csv", points + last).find("measured twice: point"), std::string::npos);
  EXPECT_NE(changed("points.csv", points + "unknown.jpg,1,0,0\n").find("image unknown.jpg has image points and is not in the table"),
            std::string::npos);
  EXPECT_NE(changed("images.csv", images + "empty.jpg,1,9999,0,0,4500\n").find("images without image points: empty.jpg"),
            std::string::npos);
  EXPECT_NE(changed("images.csv", images + images.substr(images.find('\n') + 1)).find("is there twice"), std::string::npos);
  const std::string first = control.substr(control.find('\n') + 1);
  EXPECT_NE(changed("control.csv", control + first.substr(0, first.find('\n') + 1)).find("is there twice, first in"), std::string::npos);
  swath::test::write_bytes(folder.path() / "heights.csv", "name,x,y,z\nother,0,0,0\n");
  EXPECT_NE(changed("control.csv", "name,x,y,z\nnone,0,0,0\n").find("no control point is measured on an image: none"), std::string::npos);
}

}  // namespace
}  // namespace swath::calib
