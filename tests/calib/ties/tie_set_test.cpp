// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_set.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double rounding = 1e-12;

TEST(TieSet, AxesAreRightHandedAndTheFirstIsHorizontal) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 200; ++k) {
    const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const auto axes = plane_axes(n);
    EXPECT_NEAR(axes[0].z(), 0.0, rounding);
    EXPECT_NEAR(axes[0].norm(), 1.0, rounding);
    EXPECT_NEAR((axes[0].cross(axes[1]) - n).norm(), 0.0, rounding);
  }
}

TEST(TieSet, OfALevelPlaneTheFirstAxisIsEast) {
  const auto axes = plane_axes(Vector3d::UnitZ());
  EXPECT_NEAR((axes[0] - Vector3d::UnitX()).norm(), 0.0, rounding);
  EXPECT_NEAR((axes[1] - Vector3d::UnitY()).norm(), 0.0, rounding);
  // Nearly level and still at right angles.
  const Vector3d n = Vector3d(1e-9, -2e-9, 1.0).normalized();
  const auto near = plane_axes(n);
  EXPECT_NEAR(near[0].dot(n), 0.0, rounding);
  EXPECT_NEAR(near[0].x(), 1.0, rounding);
}

TEST(TieSet, EveryKindHasItsName) {
  EXPECT_EQ(name_of(TieKind::ground), "ground");
  EXPECT_EQ(name_of(TieKind::roof), "roof");
  EXPECT_EQ(name_of(TieKind::wall), "wall");
  EXPECT_EQ(name_of(TieKind::target), "target");
}

}  // namespace
}  // namespace swath::calib
