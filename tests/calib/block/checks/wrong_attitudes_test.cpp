// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/wrong_attitudes.h"

#include <gtest/gtest.h>

#include "tests/calib/block/checks/refusal.h"

namespace swath::calib {
namespace {

/// Attitudes of a block with tilts of 2 deg, of some kind, and what they are stated to be: too little for the start values to show.
std::string refused(const char* kind, const char* stated, const char* use, bool boresight = false) {
  test::Making making = test::small_making();
  making.tilt = 0.035;
  if (!boresight) making.boresight.setZero();
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true;
  m.angles = kind, m.stated_angles = stated, m.angle_use = use;
  const test::TemporaryFolder folder;
  const std::string file = test::write_made(m, folder.path());
  BlockConfig config = test::read_made(file);
  if (boresight) config.cameras[0].sigma.boresight = "free";
  ReadBlock read = read_block(config, file);
  const ReadBlock before = read;
  try {
    refuse_mistakes(read, config);
    adjust_block(read.block, config.adjust);
    refuse_wrong_attitudes(before, read, config);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(WrongAttitudes, TheOrderOfOmegaAndPhi) {
  const std::string omega = refused("omega_phi_kappa", "phi_omega_kappa", "observed"),
                    phi = refused("phi_omega_kappa", "omega_phi_kappa", "observed");
  EXPECT_NE(omega.find("the angles are omega phi kappa, not phi omega kappa: attitudes differ"), std::string::npos) << omega;
  EXPECT_NE(phi.find("the angles are phi omega kappa, not omega phi kappa: attitudes differ"), std::string::npos) << phi;
}

TEST(WrongAttitudes, AnUnknownBoresightDoesNotHideIt) {
  const std::string omega = refused("omega_phi_kappa", "phi_omega_kappa", "observed", true);
  EXPECT_NE(omega.find("the angles are omega phi kappa, not phi omega kappa"), std::string::npos) << omega;
}

TEST(WrongAttitudes, RightOnesPass) {
  for (const bool boresight : {false, true})
    for (const char* kind : {"omega_phi_kappa", "phi_omega_kappa", "roll_pitch_heading"})
      EXPECT_EQ(refused(kind, kind, "observed", boresight), "") << kind;
}

TEST(WrongAttitudes, ValuesToStartFromAreNotJudged) { EXPECT_EQ(refused("omega_phi_kappa", "phi_omega_kappa", "start"), ""); }

}  // namespace
}  // namespace swath::calib
