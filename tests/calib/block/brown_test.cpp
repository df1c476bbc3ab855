// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/brown.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

CameraVector some_camera() {
  CameraVector c;
  c << 35.0, 0.1, -0.2, 1e-4, -2e-7, 3e-10, 2e-5, -1e-5, 1e-4, -2e-4;
  return c;
}

TEST(Brown, ImageAndDirectionAreEachOthersInverse) {
  constexpr double tolerance = 1e-10;  // mm; Newton's method ends at 1e-12 of the distance
  for (const DistortionAt at : {DistortionAt::ideal, DistortionAt::measured})
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(0, 0), Eigen::Vector2d(12, -7), Eigen::Vector2d(-18, 12)}) {
      const auto d = direction_of(some_camera(), at, p);
      ASSERT_TRUE(d);
      EXPECT_LT((*image_of(some_camera(), at, 3.7 * *d) - p).norm(), tolerance);
    }
}

TEST(Brown, DistortionIsMeasuredLessIdeal) {
  CameraVector c = CameraVector::Zero();
  c[0] = 50.0, c[3] = 1e-4;
  // At 10 mm: 1e-4 * 10^3 = 0.1 mm outwards.
  EXPECT_NEAR(image_of(c, DistortionAt::ideal, {10.0, 0.0, -50.0})->x(), 10.1, 1e-12);
  EXPECT_NEAR(direction_of(c, DistortionAt::measured, {10.0, 0.0})->x(), 9.9, 1e-12);
  c[3] = 0.0, c[6] = 1e-4, c[7] = 2e-4;  // p1 (r^2 + 2 x^2) + 2 p2 x y and p2 (r^2 + 2 y^2) + 2 p1 x y
  const auto p = image_of(c, DistortionAt::ideal, {10.0, 5.0, -50.0});
  EXPECT_NEAR(p->x(), 10.0 + 1e-4 * 325.0 + 2e-4 * 100.0, 1e-12);
  EXPECT_NEAR(p->y(), 5.0 + 2e-4 * 175.0 + 1e-4 * 100.0, 1e-12);
}

TEST(Brown, WhatIsBehindOrFoldsHasNoImage) {
  EXPECT_FALSE(image_of(some_camera(), DistortionAt::ideal, {0.0, 0.0, 1.0}));
  CameraVector c = CameraVector::Zero();
  c[0] = 35.0, c[3] = -1e-2;  // the image folds back from 5.8 mm on
  EXPECT_FALSE(direction_of(c, DistortionAt::ideal, {20.0, 0.0}));
  // 9 mm of the ideal image would be seen at 1.7 mm, where 1.8 mm are.
  EXPECT_TRUE(image_of(c, DistortionAt::ideal, {5.0, 0.0, -35.0}));
  EXPECT_FALSE(image_of(c, DistortionAt::ideal, {9.0, 0.0, -35.0}));
}

}  // namespace
}  // namespace swath::calib
