// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/stated_values.h"

#include <gtest/gtest.h>

#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

constexpr double truth[3] = {0.573, -0.344, 0.458};  // deg, about: Making's boresight

/// Findings of a block whose boresight is stated like this, to 0.02 deg.
std::vector<std::string> findings(double roll, double pitch, double heading, const char* f = "0.01 mm", double f_off = 0.0) {
  test::Making making = test::small_making();
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  m.angles = m.stated_angles = "roll_pitch_heading", m.angle_use = "observed";
  const test::TemporaryFolder folder;
  const std::string file = test::write_made(m, folder.path());
  BlockConfig config = test::read_made(file);
  CameraConfig& camera = config.cameras[0];
  camera.boresight = {core::Radians(roll * core::degree), core::Radians(pitch * core::degree), core::Radians(heading * core::degree)};
  camera.sigma.boresight = "0.02 deg", camera.sigma.f = f;
  camera.f.value += 1e-3 * f_off;
  ReadBlock read = read_block(config, file);
  const ReadBlock before = read;
  const BlockSolution solution = adjust_block(read.block, config.adjust);
  return stated_value_findings(before, config, findings_of(read, config, solution));
}

/// In the body's axes, as the block has it adjusted.
Eigen::Vector3d true_boresight() {
  Eigen::Matrix3d nominal;
  nominal << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const core::Attitude a = core::attitude_of(nominal * core::exp_so3(test::small_making().boresight) * nominal.transpose());
  return Eigen::Vector3d(a.roll, a.pitch, a.heading) / core::degree;
}

TEST(StatedValues, ThoseWithinTheirSigmasAreNotNamed) {
  const Eigen::Vector3d b = true_boresight();
  EXPECT_NEAR(std::abs(b.x()), truth[0], 0.01);
  EXPECT_NEAR(std::abs(b.y()), std::abs(truth[1]), 0.01);
  const auto found = findings(b.x() + 0.02, b.y() - 0.03, b.z());
  EXPECT_TRUE(found.empty()) << found.front();
}

TEST(StatedValues, TheOppositeSignOfAnAngle) {
  const Eigen::Vector3d b = true_boresight();
  const auto found = findings(b.x(), -b.y(), b.z());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("boresight_pitch of camera RMK is"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("the opposite sign explains it"), std::string::npos) << found[0];
}

TEST(StatedValues, AnotherValueHasNoSign) {
  const Eigen::Vector3d b = true_boresight();
  const auto found = findings(b.x(), b.y(), b.z(), "0.01 mm", 0.2);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("f of camera RMK is 15"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("check the value, its sign and its sigma"), std::string::npos) << found[0];
}

}  // namespace
}  // namespace swath::calib
