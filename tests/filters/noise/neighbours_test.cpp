// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace swath::filters {
namespace {

constexpr double exact = 1e-9;  // m: the same sum in another order

core::Block cloud(size_t n, double width, double height) {
  core::Block b;
  b.origin = {500000.0, 5400000.0, 0.0};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  core::resize(b, n);
  for (size_t p = 0; p < n; ++p) {
    // Dense in one corner, thin in the other.
    b.x[p] = width * std::pow(place(random), 2);
    b.y[p] = width * place(random);
    b.z[p] = height * place(random);
  }
  return b;
}

TEST(Neighbours, MeanDistancesAreThoseOfTheDefinition) {
  for (const double height : {0.5, 30.0}) {
    core::Block b = cloud(1500, 60.0, height);
    for (size_t p = 0; p < 5; ++p) b.x[p] = b.x[100], b.y[p] = b.y[100], b.z[p] = b.z[100];  // twins
    b.z[7] += 500.0;
    for (size_t p = 800; p < 1100; ++p) b.x[p] = b.x[100], b.y[p] = b.y[100];  // a mast
    for (size_t p = 1100; p < 1400; ++p)
      b.x[p] = b.x[101] + 1e-3 * static_cast<double>(p % 5), b.y[p] = b.y[101], b.z[p] = b.z[101];  // many at five places
    std::vector<std::uint8_t> takes_part(b.size(), 1), wanted(b.size(), 1);
    for (size_t p = 0; p < b.size(); p += 7) takes_part[p] = wanted[p] = 0;
    for (size_t p = 1; p < b.size(); p += 3) wanted[p] = 0;
    for (const int k : {1, 8, 40}) {
      constexpr double reach = 6.0;
      const std::vector<double> mean = mean_neighbour_distance(b, takes_part, wanted, k, reach);
      for (size_t p = 0; p < b.size(); ++p) {
        if (!wanted[p]) {
          EXPECT_TRUE(std::isnan(mean[p]));
          continue;
        }
        std::vector<double> all;
        for (size_t q = 0; q < b.size(); ++q)
          if (q != p && takes_part[q]) all.push_back(std::min(reach, std::hypot(b.x[q] - b.x[p], b.y[q] - b.y[p], b.z[q] - b.z[p])));
        std::sort(all.begin(), all.end());
        double sum = 0;
        for (int m = 0; m < k; ++m) sum += all[static_cast<size_t>(m)];
        ASSERT_NEAR(mean[p], sum / k, exact) << p << " k " << k;
      }
    }
  }
}

TEST(Neighbours, APointAloneGetsTheReachExactly) {
  core::Block b = cloud(3, 10.0, 1.0);
  b.x[2] += 1000.0;
  const std::vector<std::uint8_t> all(3, 1);
  EXPECT_EQ(mean_neighbour_distance(b, all, all, 2, 5.0)[2], 5.0);
  EXPECT_TRUE(mean_neighbour_distance({}, {}, {}, 8, 5.0).empty());
}

}  // namespace
}  // namespace swath::filters
