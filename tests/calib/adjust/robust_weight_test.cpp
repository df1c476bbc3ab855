// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/robust_weight.h"

#include <gtest/gtest.h>

#include "tests/world/navigation.h"

namespace swath::calib {
namespace {

TEST(RobustWeight, ThreeParts) {
  const RobustWeight w(2.0, 6.0);
  EXPECT_EQ(w(0.0), 1.0);
  EXPECT_EQ(w(-2.0), 1.0);
  EXPECT_DOUBLE_EQ(w(4.0), 0.5 * 0.25);
  EXPECT_EQ(w(-4.0), w(4.0));
  EXPECT_EQ(w(6.0), 0.0);
  EXPECT_EQ(w(1e30), 0.0);
  EXPECT_LT(w(3.1), w(3.0));
}

TEST(RobustWeight, SumsOfNormalDeviatesGiveTheirVariance) {
  const RobustWeight w(2.5, 6.0);
  swath::test::Dice dice(3);
  double sum = 0.0;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double z = dice.normal();
    sum += w(z) * z * z;
  }
  EXPECT_NEAR(sum / n / w.consistency(), 1.0, 0.01);  // 4 sigma of the mean of so many
  EXPECT_LT(w.consistency(), 1.0);
  EXPECT_NEAR(RobustWeight(20.0, 30.0).consistency(), 1.0, 1e-6);
}

}  // namespace
}  // namespace swath::calib
