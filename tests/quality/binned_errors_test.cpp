// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/binned_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

constexpr double width = 1e-3;  // m

struct Counted {
  ErrorSums sums;
  Bins bins;
  void add(double e) {
    sums.add(e);
    ++bins[bin_of(e, width)];
  }
};

/// 200 000 normal errors: their measures are known to about sigma / sqrt(n) = 0.1 mm, bins add half of their width.
TEST(BinnedErrors, OfNormalErrorsAreTheirMeasures) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.02, 0.05);
  Counted c;
  for (int k = 0; k < 200000; ++k) c.add(normal(random));
  const BinnedStatistics s = statistics_of(c.sums, c.bins, width);
  EXPECT_EQ(s.n, 200000u);
  EXPECT_NEAR(s.mean, 0.02, 5e-4);
  EXPECT_NEAR(s.std, 0.05, 5e-4);
  EXPECT_NEAR(s.rms, std::hypot(0.02, 0.05), 5e-4);
  EXPECT_NEAR(s.median, 0.02, 1e-3);
  EXPECT_NEAR(s.nmad, 0.05, 1e-3);
  EXPECT_NEAR(s.q68, 0.0542, 1e-3);  // of |N(0.02, 0.05)|
  EXPECT_NEAR(s.q95, 0.1055, 2e-3);
}

TEST(BinnedErrors, AConstantIsItself) {
  Counted c;
  for (int k = 0; k < 10; ++k) c.add(-0.05);
  const BinnedStatistics s = statistics_of(c.sums, c.bins, width);
  EXPECT_NEAR(s.median, -0.05, width / 2);
  EXPECT_NEAR(s.q95, 0.05, width / 2);
  EXPECT_NEAR(s.std, 0.0, 1e-8);  // a root of rounding errors
  EXPECT_LE(s.nmad, width);
}

TEST(BinnedErrors, OfNothingAreNotANumber) {
  const BinnedStatistics s = statistics_of({}, {}, width);
  EXPECT_EQ(s.n, 0u);
  for (const double v : {s.mean, s.std, s.rms, s.median, s.nmad, s.q68, s.q95}) EXPECT_TRUE(std::isnan(v));
}

TEST(BinnedErrors, FarOnesCountInTheOutermostBin) {
  EXPECT_EQ(bin_of(1e9, width), 1000000);
  EXPECT_EQ(bin_of(-1e9, width), -1000000);
}

}  // namespace
}  // namespace swath::quality
