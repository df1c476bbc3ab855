// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/config/result_visitors.h"

namespace swath::report {
namespace {

TEST(Statistics, SmallExampleByHand) {
  const Statistics s = statistics({-1.0, 2.0, 0.0, 3.0, std::nan("")});
  EXPECT_EQ(s.n, 4u);
  EXPECT_EQ(s.skipped, 1u);
  EXPECT_DOUBLE_EQ(s.mean, 1.0);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(10.0 / 3.0));
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(14.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.median, 1.0);
  EXPECT_DOUBLE_EQ(s.nmad, 1.4826 * 1.5);  // deviations 2, 1, 1, 2
  EXPECT_DOUBLE_EQ(s.q95, 2.0 + 0.85);     // |e| = 0, 1, 2, 3 at 2.85
  EXPECT_DOUBLE_EQ(s.minimum, -1.0);
  EXPECT_DOUBLE_EQ(s.max_abs, 3.0);
}

TEST(Statistics, FewOrNoValues) {
  const Statistics none = statistics({});
  EXPECT_EQ(none.n, 0u);
  EXPECT_TRUE(std::isnan(none.mean));
  const Statistics one = statistics({0.25});
  EXPECT_TRUE(std::isnan(one.std));
  EXPECT_EQ(one.median, 0.25);
  EXPECT_EQ(one.nmad, 0.0);
  EXPECT_EQ(core::reported(none).members().size(), 1u);
  EXPECT_EQ(core::reported(one).find("std"), nullptr);
}

TEST(Statistics, NormalErrorsWithOutliers) {
  // The robust measures hardly see one outlier in a hundred; the standard deviation does.
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.02, 0.05);
  std::vector<double> e(100000);
  for (size_t i = 0; i < e.size(); ++i) e[i] = i % 100 == 0 ? 5.0 : normal(random);
  const Statistics s = statistics(e);
  EXPECT_NEAR(s.median, 0.02, 0.002);  // six standard errors and the shift by 1 % of values
  EXPECT_NEAR(s.nmad, 0.05, 0.002);
  EXPECT_GT(s.std, 0.4);
  EXPECT_EQ(s.max_abs, 5.0);
}

}  // namespace
}  // namespace swath::report
