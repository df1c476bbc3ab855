// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/exposures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(Exposures, SeenAtIsBrownsModel) {
  CameraOptions c;
  c.f = core::Metres(0.05), c.x0 = core::Metres(1e-5), c.y0 = core::Metres(-2e-5);
  c.k1 = 1e-5, c.k2 = 0.0, c.p1 = 2e-6, c.p2 = 0.0;
  const Vector2d at = *seen_at(c, {0.2, -0.1, -1.0});  // x 10 mm, y -5 mm: r^2 125
  EXPECT_NEAR(at.x(), 0.01 + 10.0 + 10.0 * 125.0 * 1e-5 + 2e-6 * (125.0 + 200.0), 1e-12);
  EXPECT_NEAR(at.y(), -0.02 - 5.0 - 5.0 * 125.0 * 1e-5 + 2e-6 * 2.0 * 10.0 * -5.0, 1e-12);
  EXPECT_FALSE(seen_at(c, {0.2, -0.1, 1.0}));
  EXPECT_FALSE(seen_at(c, {0.6, 0.0, -1.0}));
}

TEST(Exposures, WhatIsSeenAtAPlaceIsSeenFromIt) {
  const CameraOptions c;
  const double half_x = 0.5e3 * c.columns * c.pixel.value, half_y = 0.5e3 * c.rows * c.pixel.value;
  for (double u = -1.0; u <= 1.0; u += 0.25)
    for (double v = -1.0; v <= 1.0; v += 0.25) {
      const Vector2d at(0.999 * u * half_x, 0.999 * v * half_y);
      const auto back = seen_at(c, seen_from(c, at));
      ASSERT_TRUE(back);
      EXPECT_LT((*back - at).norm(), 1e-3 * 1e3 * c.pixel.value);
    }
}

}  // namespace
}  // namespace swath::simulate
