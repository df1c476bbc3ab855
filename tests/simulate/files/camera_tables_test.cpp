// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/camera_tables.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::simulate {
namespace {

io::Survey described(const Options& o, bool check = true) {
  io::Survey out;
  describe_camera(o, {1, 1, 1, 0, true, check}, out);
  return out;
}

TEST(CameraTables, MountingIsStatedWithErrorsOfItsSigmas) {
  Options o;
  o.camera.boresight_sigma = core::degrees(0.05), o.camera.lever_arm_sigma = core::Metres(0.03);
  double angles = 0.0, arms = 0.0;
  constexpr int seeds = 200;
  for (o.seed = 1; o.seed <= seeds; ++o.seed) {
    const io::SurveyCamera c = described(o).cameras.at(0);
    EXPECT_EQ(c.sigma.boresight, "0.05 deg");
    EXPECT_EQ(c.sigma.lever_arm, "0.03 m");
    for (size_t k = 0; k < 3; ++k) {
      angles += std::pow((c.boresight[k] - o.camera.boresight[k]).value / o.camera.boresight_sigma.value, 2) / (3.0 * seeds);
      arms += std::pow((c.lever_arm[k] - o.camera.lever_arm[k]).value / 0.03, 2) / (3.0 * seeds);
    }
  }
  const double four_sigma = 4.0 * std::sqrt(2.0 / (3.0 * seeds));
  EXPECT_NEAR(angles, 1.0, four_sigma);
  EXPECT_NEAR(arms, 1.0, four_sigma);
}

TEST(CameraTables, WithoutNoiseItIsTrueAndWithoutSigmaHeld) {
  Options o;
  o.noise.noise_free = true;
  EXPECT_EQ(described(o).cameras.at(0).boresight, o.camera.boresight);
  o.noise.noise_free = false;
  o.camera.boresight_sigma = core::Radians(0.0);
  const io::Survey s = described(o, false);
  EXPECT_EQ(s.cameras[0].boresight, o.camera.boresight);
  EXPECT_EQ(s.cameras[0].sigma.boresight, "held");
  ASSERT_EQ(s.control.size(), 1u) << "no check point is on an image";
  EXPECT_EQ(s.control[0].file, "block_control.csv");
}

}  // namespace
}  // namespace swath::simulate
