// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/block.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

TEST(Colours, OfOnePlaceAreTheSameAndOfAnotherNot) {
  const Vector3d p(12.3, -45.6, 601.0);
  EXPECT_EQ(colour_of(2, p, 7), colour_of(2, p, 7));
  EXPECT_NE(colour_of(2, p, 7), colour_of(2, p, 8));
  EXPECT_NE(colour_of(2, p, 7), colour_of(6, p, 7));
}

TEST(Colours, ChangeGraduallyAndHaveContrast) {
  constexpr double step = 0.02;
  int worst = 0;
  double sum = 0.0, squares = 0.0;
  constexpr int n = 20000;
  for (int k = 0; k < n; ++k) {
    const Vector3d p(0.37 * k, -0.21 * k, 600.0);
    const auto a = colour_of(core::point_class::ground, p, 7), b = colour_of(core::point_class::ground, p + Vector3d(step, 0, 0), 7);
    worst = std::max(worst, std::abs(static_cast<int>(a[0]) - static_cast<int>(b[0])));
    sum += a[0], squares += std::pow(a[0], 2);
  }
  EXPECT_LE(worst, 8);  // over 2 cm
  EXPECT_GT(std::sqrt(squares / n - std::pow(sum / n, 2)), 12.0);
}

}  // namespace
}  // namespace swath::simulate
