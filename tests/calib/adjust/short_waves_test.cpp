// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/short_waves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::calib {
namespace {

// Three lines of 20 s with 40 groups a second, standardised residuals plus a wave of 1.5 s along the line.
std::vector<GroupResidual> groups_with(double shift, double turn) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<GroupResidual> out;
  for (std::uint32_t line = 0; line < 3; ++line)
    for (int i = 0; i < 800; ++i) {
      GroupResidual g;
      g.line = line;
      g.returns = 50;
      g.time = 1000.0 * line + 20.0 * i / 800.0;
      g.angle = 0.4 * std::sin(12.9898 * i);
      g.redundancy = 0.8;
      const double wave = std::sin(2.0 * 3.14159265 * g.time / 1.5);
      g.w = normal(random) + wave * (shift + turn * g.angle / 0.4);
      out.push_back(g);
    }
  return out;
}

TEST(ShortWaves, NoiseHasNone) {
  const ShortWaves w = short_waves(groups_with(0.0, 0.0), 0.5);
  EXPECT_EQ(w.stretches, 120);
  EXPECT_NEAR(w.shift, 1.0, 0.4);
  EXPECT_NEAR(w.turn, 1.0, 0.4);
  EXPECT_FALSE(w.seen());
}

TEST(ShortWaves, WavesAreToldByTheirKind) {
  const ShortWaves up = short_waves(groups_with(0.7, 0.0), 0.5), roll = short_waves(groups_with(0.0, 0.9), 0.5);
  EXPECT_TRUE(up.seen());
  EXPECT_GT(up.shift, 3.0);
  EXPECT_LT(up.turn, 1.5);
  EXPECT_TRUE(roll.seen());
  EXPECT_GT(roll.turn, 3.0);
  EXPECT_LT(roll.shift, 1.5);
}

TEST(ShortWaves, RejectedGroupsTakeNoPart) {
  std::vector<GroupResidual> groups = groups_with(0.0, 0.0);
  for (size_t i = 0; i < groups.size(); i += 3) groups[i].rejected = true, groups[i].w = 50.0;
  EXPECT_FALSE(short_waves(groups, 0.5).seen());
  EXPECT_FALSE(short_waves({}, 0.5).seen());
}

}  // namespace
}  // namespace swath::calib
