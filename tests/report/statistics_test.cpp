// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/config/result_visitors.h"
#include "core/error.h"

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
  EXPECT_EQ(s.resolution, 0.0);
}

TEST(Statistics, FewOrNoValues) {
  const Statistics none = statistics({});
  EXPECT_EQ(none.n, 0u);
  EXPECT_TRUE(std::isnan(none.mean));
  EXPECT_EQ(core::reported(none).members().size(), 1u);
  const Statistics one = statistics({0.25});
  EXPECT_TRUE(std::isnan(one.std));
  EXPECT_EQ(one.median, 0.25);
  EXPECT_EQ(one.nmad, 0.0);
  EXPECT_EQ(core::reported(one).find("std"), nullptr);
  EXPECT_DOUBLE_EQ(core::reported(one).find("rms")->as_number(), 0.25);
  EXPECT_EQ(StreamingStatistics().result().n, 0u);
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

TEST(Statistics, StreamAgreesWithTheVector) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal(-0.3, 0.07);
  std::vector<double> e(20000);
  for (double& v : e) v = normal(random);
  const Statistics exact = statistics(e);
  StreamingStatistics whole, first, second;
  for (size_t i = 0; i < e.size(); ++i) {
    whole.add(e[i]);
    (i < 7000 ? first : second).add(e[i]);
  }
  whole.add(std::nan(""));
  second.add(std::nan(""));
  first.merge(second);
  constexpr double rounding = 1e-12, bin = 0.001;
  for (const Statistics& s : {whole.result(), first.result()}) {
    EXPECT_EQ(s.n, exact.n);
    EXPECT_EQ(s.skipped, 1u);
    EXPECT_NEAR(s.mean, exact.mean, rounding);
    EXPECT_NEAR(s.std, exact.std, rounding);
    EXPECT_NEAR(s.rms, exact.rms, rounding);
    EXPECT_EQ(s.minimum, exact.minimum);
    EXPECT_EQ(s.maximum, exact.maximum);
    EXPECT_NEAR(s.median, exact.median, bin);
    EXPECT_NEAR(s.q68, exact.q68, bin);
    EXPECT_NEAR(s.q95, exact.q95, bin);
    EXPECT_NEAR(s.nmad, exact.nmad, 3.0 * bin);
    EXPECT_EQ(s.resolution, bin);
  }
  EXPECT_EQ(whole.result().median, first.result().median);
}

TEST(Statistics, BeyondReachIsTheExtreme) {
  StreamingStatistics s(0.1, 1.0);
  for (const double e : {-50.0, 0.05, 20.0, 30.0, 40.0}) s.add(e);
  const Statistics r = s.result();
  EXPECT_EQ(r.median, 40.0);
  EXPECT_EQ(r.q95, 50.0);
  EXPECT_EQ(r.minimum, -50.0);
}

TEST(Statistics, BadBinsAreRefused) {
  EXPECT_THROW(StreamingStatistics(0.0, 1.0), core::Error);
  EXPECT_THROW(StreamingStatistics(0.1, -1.0), core::Error);
  EXPECT_THROW(StreamingStatistics(1e-9, 1e3), core::Error);
  StreamingStatistics a(0.1, 1.0);
  EXPECT_THROW(a.merge(StreamingStatistics(0.2, 1.0)), core::Error);
}

}  // namespace
}  // namespace swath::report
