// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/mount_directions.h"

#include <gtest/gtest.h>

#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

/// The true mount is 0 deg. Angles of the camera do not follow the mount, those of the body do.
std::string finding(double mount, const char* angles, bool level = false) {
  test::Making making = test::small_making();
  making.boresight.setZero();
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = !level;
  m.angles = m.stated_angles = angles;
  const test::TemporaryFolder folder;
  const std::string file = test::write_made(m, folder.path());
  BlockConfig config = test::read_made(file);
  config.cameras[0].mount = core::Radians(mount * core::degree);
  const std::vector<std::string> found = mount_findings(read_block(config, file), config);
  return found.empty() ? "" : found.front();
}

TEST(MountDirections, AWrongMountIsNamedWithTheRightOne) {
  EXPECT_EQ(finding(0.0, "omega_phi_kappa"), "");
  EXPECT_EQ(finding(12.0, "omega_phi_kappa"), "") << "crab";
  for (const double mount : {90.0, -90.0, 180.0})
    for (const char* angles : {"omega_phi_kappa", "phi_omega_kappa"}) {
      const std::string found = finding(mount, angles);
      EXPECT_NE(found.find("state mount = \"0 deg\""), std::string::npos) << mount << " " << found;
    }
  EXPECT_NE(finding(90.0, "omega_phi_kappa").find("-90 deg from the direction of flight"), std::string::npos);
}

TEST(MountDirections, AnglesOfTheBodyAndLevelImagesAreJudgedByTheImages) {
  EXPECT_EQ(finding(90.0, "roll_pitch_heading"), "");
  EXPECT_EQ(finding(90.0, "omega_phi_kappa", true), "");
}

}  // namespace
}  // namespace swath::calib
