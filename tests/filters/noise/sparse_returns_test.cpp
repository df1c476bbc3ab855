// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/sparse_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

/// Four returns per square metre where `share` of (x, y) is 1.
core::Block fly(const std::function<double(double, double)>& share) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  core::Block b;
  for (double y = 0.0; y < 200.0; y += 0.5)
    for (double x = 0.0; x < 200.0; x += 0.5) {
      const double px = x + 0.5 * uniform(random), py = y + 0.5 * uniform(random);
      if (uniform(random) < share(px, py)) test::add_point(b, px, py, 0.0);
    }
  return b;
}
SparseReturns judged(const core::Block& b) {
  return sparse_returns(b, Bins(b, 4.0, sparse_circle, [](size_t) { return true; }), 0.12);
}

TEST(SparseReturns, AreThoseWherePulsesStayAway) {
  const core::Block b = fly([](double x, double y) { return std::hypot(x - 100.0, y - 100.0) < 40.0 ? 0.03 : 1.0; });
  const SparseReturns found = judged(b);
  constexpr double border = 2.5;  // m: radius of the circle of 50 returns, and the shore's scatter
  double inside = 0, said = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    const double r = std::hypot(b.x[p] - 100.0, b.y[p] - 100.0);
    if (r > 40.0) {
      EXPECT_EQ(found.sparse[p], 0) << b.x[p] << " " << b.y[p];
    }
    if (r < 40.0 - border) ++inside, said += found.sparse[p];
  }
  EXPECT_GE(said, 0.95 * inside);  // some stand together by chance
  const auto middle = *std::max_element(found.usual.begin(), found.usual.end());
  EXPECT_NEAR(middle, 64.0, 2.0);  // 4 per square metre on 16
}

TEST(SparseReturns, EdgesCornersAndThinSurveysHaveNone) {
  const std::vector<std::function<double(double, double)>> places = {
      [](double x, double y) { return std::abs(x + y - 200.0) < 20.0 ? 0.0 : 1.0; },
      [](double x, double y) { return std::fmod(x, 30.0) < 15.0 && std::fmod(y, 30.0) < 15.0 ? 1.0 : 0.0; },
      [](double x, double) { return x < 100.0 ? 0.5 : 1.0; },
      [](double, double) { return 0.05; },
  };
  for (size_t k = 0; k < places.size(); ++k) {
    double n = 0;
    for (const std::uint8_t s : judged(fly(places[k])).sparse) n += s;
    EXPECT_EQ(n, 0.0) << k;
  }
}

TEST(SparseReturns, EachLineIsJudgedOnItsOwn) {
  const auto lake = [](double x, double y) { return std::hypot(x - 100.0, y - 100.0) < 40.0; };
  core::Block b = fly([&](double x, double y) { return lake(x, y) ? 0.03 : 1.0; });
  const size_t first = b.size();
  core::append(b, fly([](double, double) { return 1.0; }));
  b.strip.assign(b.size(), 1);
  for (size_t p = first; p < b.size(); ++p) b.strip[p] = 2;
  const SparseReturns found = judged(b);
  double n = 0;
  for (size_t p = 0; p < first; ++p) n += found.sparse[p];
  EXPECT_GT(n, 300.0);
  for (size_t p = first; p < b.size(); ++p) EXPECT_FALSE(found.sparse[p]);
}

}  // namespace
}  // namespace swath::filters
