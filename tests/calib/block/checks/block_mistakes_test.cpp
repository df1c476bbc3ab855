// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_mistakes.h"

#include <gtest/gtest.h>

#include "tests/calib/block/checks/refusal.h"

namespace swath::calib {
namespace {

/// Body angles of a block, each changed.
std::string refused(const std::function<void(core::Attitude&)>& change) {
  test::Making making = test::small_making();
  making.boresight.setZero();
  making.tilt = 0.05;
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  m.angles = m.stated_angles = "roll_pitch_heading";
  Eigen::Matrix3d ned_R_enu;
  ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  for (ImageAttitude& a : m.block.attitudes) {
    core::Attitude t = core::attitude_of(ned_R_enu * a.local_R_body);
    change(t);
    a.local_R_body = ned_R_enu.transpose() * core::matrix_of(t);
  }
  return test::refusal(m);
}

void expect_in(const std::string& text, const std::string& part) { EXPECT_NE(text.find(part), std::string::npos) << text; }

TEST(BlockMistakes, UnitsAndOrderOfAngles) {
  EXPECT_EQ(refused([](core::Attitude&) {}), "");
  const auto scaled = [](double f) { return [f](core::Attitude& a) { a.roll *= f, a.pitch *= f, a.heading *= f; }; };
  expect_in(refused(scaled(core::degree)), "the angles are in radians");
  expect_in(refused(scaled(1.0 / 0.9)), "the angles are in gon");
  expect_in(refused([](core::Attitude& a) { std::swap(a.roll, a.pitch); }), "roll and pitch are exchanged");
  expect_in(refused([](core::Attitude& a) { a.heading = core::pi / 2.0 - a.heading; }), "heading counts counter-clockwise from east");
}

TEST(BlockMistakes, AnglesOfTheCameraForThoseOfTheBody) {
  test::Making making = test::small_making();
  making.boresight.setZero();
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  for (const char* kind : {"omega_phi_kappa", "phi_omega_kappa"}) {
    // A table with the columns omega, phi and kappa under the names of the others.
    m.angles = kind, m.stated_angles = "roll_pitch_heading";
    const test::TemporaryFolder folder;
    const std::string file = test::write_made(m, folder.path());
    const BlockConfig config = test::read_made(file);
    m.angles = m.stated_angles = kind;
    const test::TemporaryFolder right;
    const std::string as_is = test::write_made(m, right.path());
    ReadBlock read = read_block(test::read_made(as_is), as_is);
    for (const StatedAngles& a : read.angles)
      set_attitude(read.block, a.image, body_attitude(read, a.image, a.value, ImageAngles::roll_pitch_heading, ImageNorth::grid));
    try {
      refuse_mistakes(read, config);
      FAIL() << kind;
    } catch (const core::Error& e) {
      expect_in(e.text(), "kappa of the camera, not roll pitch heading");
    }
  }
}

TEST(BlockMistakes, HeadingsTurnedByQuarters) {
  for (const auto& [by, what] : {std::pair{180.0, "by 180 deg"}, {90.0, "by 90 deg"}, {-90.0, "by -90 deg"}})
    expect_in(refused([turn = by * core::degree](core::Attitude& a) { a.heading += turn; }), std::string("headings are off ") + what);
}

TEST(BlockMistakes, DistortionWithTheSignOfCorrections) {
  test::Making making = test::small_making();
  making.boresight.setZero();
  making.camera[3] = 4e-7;  // k1: 0.6 mm in the corners
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  m.angles = m.stated_angles = "roll_pitch_heading";
  const test::TemporaryFolder folder;
  const std::string file = test::write_made(m, folder.path());
  const BlockConfig config = test::read_made(file);
  ReadBlock read = read_block(config, file);
  read.block.cameras[0].value[3] = making.camera[3];
  EXPECT_NO_THROW(refuse_mistakes(read, config));
  read.block.cameras[0].value[3] = -making.camera[3];
  try {
    refuse_mistakes(read, config);
    FAIL() << "corrections were taken for distortion";
  } catch (const core::Error& e) {
    expect_in(e.text(), "the distortion has the other sign");
  }
  read.block.cameras[0].sigma[3] = free_value;  // a start value
  EXPECT_NO_THROW(refuse_mistakes(read, config));
}

/// A run has no table of angles to correct.
TEST(BlockMistakes, AnglesOfATrajectoryHaveItsHint) {
  ReadBlock read;
  read.block.cameras.resize(1);
  BlockConfig config;
  config.images.angles = ImageAngles::roll_pitch_heading, config.images.north = ImageNorth::true_north;
  const auto by_table = mistakes_of_angles(read, config);
  config.images.angles_hint = "check [[imu]]";
  const auto by_trajectory = mistakes_of_angles(read, config);
  ASSERT_EQ(by_trajectory.size(), by_table.size());
  for (size_t k = 0; k < by_table.size(); ++k) {
    EXPECT_EQ(by_trajectory[k].what, by_table[k].what);
    EXPECT_NE(by_table[k].hint, "");
    EXPECT_EQ(by_trajectory[k].hint, "check [[imu]]");
  }
}

/// The stations of strip `strip` (by its place in the table) from image `first` on are those of the image after.
std::string shifted(int strip, int first) {
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  std::vector<size_t> of;
  for (size_t s = 0; s < m.block.stations.size(); ++s)
    if (m.block.images[m.block.stations[s].image].strip == strip) of.push_back(s);
  const std::vector<ImageStation> at = m.block.stations;
  for (size_t k = static_cast<size_t>(first); k < of.size(); ++k)
    m.block.stations[of[k]].position =
        k + 1 < of.size() ? at[of[k + 1]].position : Eigen::Vector3d(2.0 * at[of[k]].position - at[of[k - 1]].position);
  return test::refusal(m);
}

TEST(BlockMistakes, OneStripIsShifted) {
  const int strip = test::make_block(test::small_making()).given.images[8].strip;  // the second, of six images
  expect_in(shifted(strip, 0), "the stations of strip " + std::to_string(strip) + " are those of the image after");
}

TEST(BlockMistakes, StationHeightsInFeet) {
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  for (ImageStation& s : m.block.stations) s.position.z() /= 0.3048;
  expect_in(test::refusal(m), "heights of the stations are in feet");
}

}  // namespace
}  // namespace swath::calib
