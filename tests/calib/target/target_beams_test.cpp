// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_beams.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double rounding = 1e-12;

TEST(TargetBeams, WhereABeamPiercesAPlane) {
  // From 20 deg aside down to ground at 0; its last return 3 m further. The plane lies 5 m up and rises to the east by 1 in 10.
  Beamline b;
  b.first = {2.0, 1.0, 0.0};
  b.back = Vector3d(std::tan(20 * core::degree), 0.0, 1.0).normalized();
  b.further = 3.0;
  b.pulse = 7;
  const Vector3d plane(5.0, 0.1, 0.0);
  const std::vector<Pierced> found = pierce({b}, plane);
  ASSERT_EQ(found.size(), 1u);
  const double up = plane[0] + plane[1] * found[0].place.x();
  EXPECT_NEAR(found[0].place.x(), 2.0 + up * std::tan(20 * core::degree), rounding) << "on the beam";
  EXPECT_NEAR(found[0].place.y(), 1.0, rounding);
  EXPECT_NEAR(found[0].slope.x(), -std::tan(20 * core::degree), rounding) << "on its way down it goes west";
  EXPECT_NEAR(found[0].first, -5.2, rounding) << "under the plane above it";
  const Vector3d last = b.first - 3.0 * b.back;
  EXPECT_NEAR(found[0].last, last.z() - plane[0] - plane[1] * last.x(), rounding);
  EXPECT_EQ(found[0].pulse, 7u);
  b.back = Vector3d(1, 0, 0.05).normalized();
  EXPECT_TRUE(pierce({b}, plane).empty()) << "nearly level";
}

// Beams straight down on a lattice: a roof of 20 m x 12 m displaced by `shift`, `up` m above the plane, over ground 8 m below it.
std::vector<Pierced> roof_at(const Vector2d& shift, double up) {
  std::vector<Pierced> out;
  for (double x = -30.0; x < 30.0; x += 0.8)
    for (double y = -30.0; y < 30.0; y += 0.8) {
      const Vector2d p = Vector2d(x, y) - shift;
      const double above = std::abs(p.x()) < 10.0 && std::abs(p.y()) < 6.0 ? up : -8.0;
      out.push_back({{x, y}, {0, 0}, above, above, out.size()});
    }
  return out;
}

TEST(TargetBeams, TheRoofIsAmongTheFrequentHeights) {
  const std::vector<double> found = frequent_heights(roof_at({0, 0}, 1.7), 12.0);
  ASSERT_EQ(found.size(), 2u);
  constexpr double bin = 0.4;  // m: counts of three bins of 0.2 m are taken together
  EXPECT_NEAR(found[0], -8.0, bin) << "most returns come from the ground";
  EXPECT_NEAR(found[1], 1.7, bin);
  EXPECT_EQ(frequent_heights(roof_at({0, 0}, 1.7), 5.0).size(), 1u) << "the ground is out of reach";
}

TEST(TargetBeams, TheShiftThatPutsTheRoofOntoItsReturns) {
  RoofTarget t;
  t.corners = {{-10, -6}, {10, -6}, {10, 6}, {-10, 6}};
  double score = 0.0;
  const Vector2d shift = coarse_shift(roof_at({4.3, -2.8}, 0.0), t, 8.0, score);
  EXPECT_LT((shift - Vector2d(4.3, -2.8)).norm(), 0.8) << "the spacing of the pulses";
  EXPECT_GT(score, 0.9);
  coarse_shift(roof_at({4.3, -2.8}, 3.0), t, 8.0, score);
  EXPECT_LT(score, 0.0) << "nothing at its height";
}

}  // namespace
}  // namespace swath::calib
