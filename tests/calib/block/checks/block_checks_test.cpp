// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_checks.h"

#include <gtest/gtest.h>

#include "tests/calib/block/checks/refusal.h"

namespace swath::calib {
namespace {

using test::refusal;

test::MadeFiles made() {
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  return m;
}

TEST(BlockChecks, ARightBlockPasses) {
  test::MadeFiles m = made();
  EXPECT_EQ(refusal(m), "");
  m.write_angles = true;
  for (const char* kind : {"omega_phi_kappa", "phi_omega_kappa", "roll_pitch_heading"}) {
    m.angles = m.stated_angles = kind;
    EXPECT_EQ(refusal(m), "") << kind;
  }
}

TEST(BlockChecks, ImageAxes) {
  test::MadeFiles m = made();
  m.y = "down";
  EXPECT_NE(refusal(m).find("the y axis of the image points has the other sense"), std::string::npos) << refusal(m);
  m.y = "up";
  for (ImageRay& r : m.block.rays) r.x = -r.x;
  EXPECT_NE(refusal(m).find("the images are mirrored"), std::string::npos) << refusal(m);
  for (ImageRay& r : m.block.rays) r.y = -r.y;
  EXPECT_NE(refusal(m).find("turned by 180 deg"), std::string::npos) << refusal(m);
  m = made();
  for (ImageRay& r : m.block.rays) std::swap(r.x, r.y);
  EXPECT_NE(refusal(m).find("x and y of the image points are exchanged"), std::string::npos) << refusal(m);
}

TEST(BlockChecks, Angles) {
  test::Making making = test::small_making();
  making.tilt = 0.1;  // the order of omega and phi is seen by their product alone: a boresight as large would hide it
  making.boresight.setZero();
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  m.stated_angles = "phi_omega_kappa";
  EXPECT_NE(refusal(m).find("the angles are omega phi kappa, not phi omega kappa"), std::string::npos) << refusal(m);
  m.angles = m.stated_angles = "roll_pitch_heading";
  for (ImageAttitude& a : m.block.attitudes) {
    // Roll with the other sign.
    Eigen::Matrix3d ned_R_enu;
    ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
    core::Attitude t = core::attitude_of(ned_R_enu * a.local_R_body);
    t.roll = -t.roll;
    a.local_R_body = ned_R_enu.transpose() * core::matrix_of(t);
  }
  EXPECT_NE(refusal(m).find("roll has the other sign"), std::string::npos) << refusal(m);
}

TEST(BlockChecks, StationsOfTheNextImage) {
  test::MadeFiles m = made();
  std::vector<ImageStation> shifted = m.block.stations;
  for (size_t s = 0; s < shifted.size(); ++s) {
    const bool same = s + 1 < shifted.size() && m.block.images[shifted[s].image].strip == m.block.images[shifted[s + 1].image].strip;
    shifted[s].position =
        same ? m.block.stations[s + 1].position : Eigen::Vector3d(2.0 * m.block.stations[s].position - m.block.stations[s - 1].position);
  }
  m.block.stations = shifted;
  EXPECT_NE(refusal(m).find("the stations are those of the image after"), std::string::npos) << refusal(m);
}

TEST(BlockChecks, ControlInFeet) {
  test::MadeFiles m = made();
  m.control_unit = 0.3048;
  EXPECT_NE(refusal(m).find("control is in feet"), std::string::npos) << refusal(m);
  m.control_unit = 1.0;
  for (BlockControl& c : m.block.control) c.position.x() += 50000.0;
  EXPECT_NE(refusal(m).find("from where the images see them"), std::string::npos) << refusal(m);
}

TEST(BlockChecks, PointsOffTheSensor) {
  test::MadeFiles m = made();
  for (ImageRay& r : m.block.rays) r.x += 115.0, r.y += 115.0;  // from a corner, not from the middle
  EXPECT_NE(refusal(m).find("image points of camera RMK reach"), std::string::npos) << refusal(m);
  m = made();
  for (ImageRay& r : m.block.rays) r.x *= 1e-3, r.y *= 1e-3;
  EXPECT_NE(refusal(m).find("check unit and pixel"), std::string::npos) << refusal(m);
}

}  // namespace
}  // namespace swath::calib
