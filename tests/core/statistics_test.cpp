// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace swath::core;

TEST(Statistics, MedianIsTheMiddleValueOrTheUpperOfTwo) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_EQ(median({}, 7.0), 7.0);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 3);
}

TEST(Statistics, QuantileIsAnOrderStatistic) {
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_EQ(quantile({}, 0.5, 0.0), 0.0);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0.0), 1);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0.25), 2);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 1.0), 5);
}

TEST(Statistics, AQuantileBetweenTwoValuesLiesOnTheLineBetweenThem) {
  std::vector<double> v{4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.9), 3.7);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(interpolated_quantile(v, 1.0), 4.0);
  std::vector<double> one{7};
  EXPECT_DOUBLE_EQ(interpolated_quantile(one, 0.3), 7.0);
}

TEST(Statistics, MedianStep) {
  EXPECT_EQ(median_step({}), 0.0);
  EXPECT_EQ(median_step({1.0}), 0.0);
  EXPECT_EQ(median_step({0.0, 1.0, 2.0, 3.0, 50.0, 51.0}), 1.0);
}

}  // namespace
