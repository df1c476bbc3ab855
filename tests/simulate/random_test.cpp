// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace swath::simulate {
namespace {

constexpr int draws = 200000;
constexpr double five_sigma = 5.0;  // a fixed seed: the bound says how far from chance the sequence may look

TEST(Random, UniformsFillTheUnitInterval) {
  double sum = 0, square = 0;
  Random r(1, 2, 3);
  for (int i = 0; i < draws; ++i) {
    const double u = r.uniform();
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    square += u * u;
  }
  EXPECT_NEAR(sum / draws, 0.5, five_sigma * std::sqrt(1.0 / 12 / draws));
  EXPECT_NEAR(square / draws, 1.0 / 3, five_sigma * std::sqrt(4.0 / 45 / draws));
}

TEST(Random, NormalsOfNeighbouringIndicesAreIndependentAndNormal) {
  double sum = 0, square = 0, fourth = 0, product = 0, previous = 0;
  for (int i = 0; i < draws; ++i) {
    const double v = Random(7, 0, static_cast<std::uint64_t>(i)).normal();
    sum += v;
    square += v * v;
    fourth += v * v * v * v;
    product += v * previous;
    previous = v;
  }
  EXPECT_NEAR(sum / draws, 0.0, five_sigma / std::sqrt(draws));
  EXPECT_NEAR(square / draws, 1.0, five_sigma * std::sqrt(2.0 / draws));
  EXPECT_NEAR(fourth / draws, 3.0, five_sigma * std::sqrt(96.0 / draws));
  EXPECT_NEAR(product / draws, 0.0, five_sigma / std::sqrt(draws));
}

TEST(Random, SequencesDependOnSeedStreamAndIndexAlone) {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (std::uint64_t stream = 0; stream < 10; ++stream)
      for (std::uint64_t index = 0; index < 10; ++index) first.insert(Random(seed, stream, index).bits());
  EXPECT_EQ(first.size(), 1000u);
  EXPECT_EQ(Random(3, 4, 5).bits(), Random(3, 4, 5).bits());
}

TEST(Random, ExponentialAndPoissonHaveTheirMeans) {
  Random r(1, 1, 1);
  double sum = 0, count = 0, square = 0;
  for (int i = 0; i < draws; ++i) {
    sum += r.exponential();
    const int n = r.poisson(4.0);
    count += n;
    square += n * n;
  }
  EXPECT_NEAR(sum / draws, 1.0, five_sigma / std::sqrt(draws));
  EXPECT_NEAR(count / draws, 4.0, five_sigma * 2 / std::sqrt(draws));
  EXPECT_NEAR(square / draws - std::pow(count / draws, 2), 4.0, 0.1);
  EXPECT_NEAR(r.poisson(10000.0), 10000, 500);
}

TEST(Random, GaussMarkovKeepsItsVarianceAndForgetsByItsTime) {
  constexpr double time = 120.0;
  for (const double step : {0.2, 7.0}) {
    GaussMarkov process(time, Random(5, 6, 7));
    constexpr int n = 3000000;
    std::vector<double> x;
    for (int i = 0; i < n; ++i, process.advance(step)) x.push_back(process.value());
    const auto lag = static_cast<size_t>(std::lround(time / step));
    double square = 0, product = 0;
    for (size_t i = 0; i + lag < x.size(); ++i) {
      square += x[i] * x[i];
      product += x[i] * x[i + lag];
    }
    const double m = static_cast<double>(x.size() - lag);
    // n step / (2 time) independent values: 2500 at 0.2 s, five sigma of a variance.
    const double chance = 5 * std::sqrt(2.0 / (n * step / (2 * time)));
    EXPECT_NEAR(square / m, 1.0, chance) << step;
    EXPECT_NEAR(product / square, std::exp(-static_cast<double>(lag) * step / time), chance) << step;
  }
}

}  // namespace
}  // namespace swath::simulate
