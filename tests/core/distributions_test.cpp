// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::core {
namespace {

constexpr double table = 6e-4;  // half a unit of the last digit of the tables, and rounding

TEST(Distributions, NormalQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(normal_quantile(0.9995), 3.290527, 1e-6);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-12);
  EXPECT_NEAR(normal_quantile(0.025), -1.959964, 1e-6);
}

TEST(Distributions, ChiSquareQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chi_square_quantile(0.99, 1.0), 6.635, table);
  EXPECT_NEAR(chi_square_quantile(0.99, 7.0), 18.475, table);
  EXPECT_NEAR(chi_square_quantile(0.99, 24.0), 42.980, table);
  EXPECT_NEAR(chi_square_limit(0.01, 24.0), 42.980, table);
}

TEST(Distributions, LimitsHoldFarOut) {
  // With two degrees of freedom chi-square is exponential: P(X > x) = exp(-x / 2).
  for (const double q : {1e-3, 1e-9, 1e-30, 1e-200}) EXPECT_NEAR(chi_square_limit(q, 2.0) / (-2.0 * std::log(q)), 1.0, 1e-12) << q;
}

TEST(Distributions, AQuantileBetweenTwoValuesLiesOnTheLineBetweenThem) {
  std::vector<double> v{4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.9), 3.7);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 1.0), 4.0);
  std::vector<double> one{7};
  EXPECT_DOUBLE_EQ(interpolated_quantile(one, 0.3), 7.0);
}

TEST(Distributions, TheMiddleChangesItsSignWithTheValues) {
  EXPECT_EQ(middle({0.0, 0.3}), 0.15);
  EXPECT_EQ(middle({0.0, -0.3}), -0.15);
  EXPECT_EQ(middle({5.0, 1.0, 2.0}), 2.0);
  EXPECT_TRUE(std::isnan(middle({})));
}

}  // namespace
}  // namespace swath::core
