// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/sparse_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/config/units.h"
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

TEST(SparseReturns, AreThoseOfTheDefinitionWhereverReturnsAreDense) {
  core::Block b = fly([](double x, double y) { return std::hypot(x - 60.0, y - 60.0) < 30.0 ? 0.03 : 1.0; });
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 4000; ++k) test::add_point(b, 100.0 + 6.0 * uniform(random), 50.0 + 4.0 * uniform(random), 0.0);  // 166 per m2
  for (int k = 0; k < 500; ++k) test::add_point(b, 61.0, 60.0 + 1e-4 * (k % 3), 0.0);                                   // nearly one place
  const Bins bins(b, 4.0, sparse_circle, [](size_t) { return true; });
  const SparseReturns found = judged(b);
  size_t sparse = 0;
  for (size_t p = 0; p < b.size(); p += 3) {
    const CellIndex c = cell_of(bins.lattice(), b, p);
    const double usual = found.usual[bins.lattice().at(c.i, c.j)];
    const double radius = std::min(4.0 * std::sqrt(50.0 / (core::pi * usual)), 4.0 * sparse_circle);
    const int most = static_cast<int>(0.12 * usual * core::pi * radius * radius / 16.0);
    int n = 0;
    for (size_t q = 0; q < b.size(); ++q)
      n += (b.x[q] - b.x[p]) * (b.x[q] - b.x[p]) + (b.y[q] - b.y[p]) * (b.y[q] - b.y[p]) <= radius * radius;
    ASSERT_EQ(found.sparse[p] != 0, n <= most) << b.x[p] << " " << b.y[p];
    sparse += n <= most;
  }
  EXPECT_GT(sparse, 50u);
}

TEST(SparseReturns, ALineInOneRowOrAtOnePlace) {
  for (const double width : {0.0, 300.0}) {
    core::Block b;
    for (int k = 0; k < 2000; ++k) test::add_point(b, 10.0 + width * k / 2000.0, 20.0, 0.0);
    for (const std::uint8_t s : judged(b).sparse) ASSERT_EQ(s, 0);
  }
}

}  // namespace
}  // namespace swath::filters
