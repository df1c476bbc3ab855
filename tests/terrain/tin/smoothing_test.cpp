// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr double radius = 2.5, side = 60.0;

double plane(double x, double y) { return 300.0 + 0.4 * x - 0.3 * y; }
double scarp(double x, double) { return 300.0 + std::clamp(1.43 * (x - 26.0), 0.0, 12.0); }  // breaks at 26 m and 34.4 m

core::Block noisy(size_t n, const test::Surface& surface, double noise, unsigned seed) {
  core::Block b = test::random_points(n, side, surface, seed);
  std::mt19937 random(seed + 1000);
  std::normal_distribution<double> gauss(0.0, 1.0);
  for (double& z : b.z) z += noise * gauss(random);
  return b;
}

Tin tin_of(const core::Block& b) { return triangulate(b, test::all_rows(b)); }

/// Root mean square of the vertices' errors at some distance from the border.
template <class Where>
double rms(const Tin& tin, const test::Surface& surface, Where where) {
  double sum = 0.0, n = 0.0;
  for (size_t v = 0; v < tin.x.size(); ++v) {
    const double x = tin.x[v], y = tin.y[v];
    if (x < 6 || y < 6 || x > side - 6 || y > side - 6 || !where(x)) continue;
    sum += std::pow(tin.z[v] - surface(x, y), 2), n += 1.0;
  }
  return std::sqrt(sum / n);
}
constexpr auto everywhere = [](double) { return true; };

TEST(Smoothing, APlaneStays) {
  Tin tin = tin_of(test::random_points(8000, side, plane, 1));
  smooth_heights(tin, 8000, radius);
  for (size_t v = 0; v < tin.x.size(); ++v) ASSERT_NEAR(tin.z[v], plane(tin.x[v], tin.y[v]), 1e-5);
}

TEST(Smoothing, TakesRandomErrorOutAndTellsWhatIsLeft) {
  struct Case {
    size_t points;
    double radius;
  };
  for (const auto& [points, within] : {Case{3000, radius}, Case{12000, radius}, Case{30000, radius}, Case{30000, 5.0}, Case{30000, 10.0},
                                       Case{108000, radius}}) {  // 0.8, 3.3, 8 and 30 per square metre
    const core::Block b = noisy(points, plane, 0.03, 2);
    Tin tin = tin_of(b);
    const std::vector<float> left = smooth_heights(tin, b.size(), within).left;
    const double after = rms(tin, plane, everywhere);
    double told = 0.0, n = 0.0;
    for (size_t v = 0; v < left.size(); ++v)
      if (tin.x[v] > 6 && tin.y[v] > 6 && tin.x[v] < side - 6 && tin.y[v] < side - 6) told += static_cast<double>(left[v]), n += 1.0;
    EXPECT_LT(after, 0.5 * 0.03) << points;
    EXPECT_NEAR(after / (0.03 * std::sqrt(told / n)), 1.0, 0.15) << points;
  }
}

TEST(Smoothing, BreaksAreKept) {
  const auto at_break = [](double x) { return std::abs(x - 26.0) < 1.0 || std::abs(x - 34.4) < 1.0; };
  const core::Block exact = test::random_points(30000, side, scarp, 3);
  Tin tin = tin_of(exact);
  smooth_heights(tin, exact.size(), radius);
  EXPECT_LT(rms(tin, scarp, at_break), 0.06);
  const core::Block b = noisy(30000, scarp, 0.1, 3);
  tin = tin_of(b);
  smooth_heights(tin, b.size(), radius);
  EXPECT_LT(rms(tin, scarp, at_break), 0.075);
  EXPECT_LT(rms(tin, scarp, everywhere), 0.05);
}

TEST(Smoothing, BorderLongEdgesAndLinesStay) {
  const core::Block b = noisy(200, plane, 0.5, 4);  // some 4 m apart
  Tin tin = tin_of(b);
  const Tin before = tin;
  const std::vector<float> left = smooth_heights(tin, b.size(), 1.0).left;
  size_t kept = 0;
  for (size_t v = 0; v < left.size(); ++v) {
    if (left[v] < 1.0F) continue;
    ASSERT_EQ(tin.z[v], before.z[v]);
    ++kept;
  }
  EXPECT_GT(kept, 190u);
  // All points stand for vertices of lines.
  tin = before;
  smooth_heights(tin, 0, 10.0);
  EXPECT_EQ(tin.z, before.z);
}

TEST(Smoothing, HowFarVerticesMoveShowsTheirScatter) {
  for (const double noise : {0.02, 0.10}) {
    const core::Block b = noisy(
        12000, [](double, double) { return 7.0; }, noise, 5);
    Tin tin = tin_of(b);
    double sum = 0.0, count = 0.0;
    for (const float m : smooth_heights(tin, b.size(), 1.0).scatter)
      if (!std::isnan(m)) sum += static_cast<double>(m), count += 1.0;
    EXPECT_GT(count, 11000.0);
    EXPECT_NEAR(std::sqrt(sum / count), noise, 0.15 * noise);
  }
}

TEST(Smoothing, NeitherOrderNorWhatLiesFarAwayMatters) {
  const core::Block b = noisy(12000, scarp, 0.05, 5);
  const Rectangle where{20.0, 20.0, 40.0, 40.0};
  const double reach = smoothing_reach(1.0);
  Tin whole = tin_of(b);
  std::vector<std::uint32_t> rows = test::all_rows(b);
  std::reverse(rows.begin(), rows.end());
  Tin part = triangulate(b, rows, std::numeric_limits<double>::infinity(),
                         {where.west - reach, where.south - reach, where.east + reach, where.north + reach});
  ASSERT_LT(part.size(), whole.size());
  const Smoothed of_whole = smooth_heights(whole, b.size(), 1.0), of_part = smooth_heights(part, b.size(), 1.0);
  const std::vector<float>&left = of_whole.left, &left_of_part = of_part.left;
  std::vector<double> height(b.size());
  std::vector<float> share(b.size()), scatter(b.size());
  for (size_t v = 0; v < whole.x.size(); ++v)
    height[whole.row[v]] = whole.z[v], share[whole.row[v]] = left[v], scatter[whole.row[v]] = of_whole.scatter[v];
  size_t compared = 0;
  for (size_t v = 0; v < part.x.size(); ++v) {
    if (part.x[v] < where.west || part.x[v] > where.east || part.y[v] < where.south || part.y[v] > where.north) continue;
    ASSERT_EQ(part.z[v], height[part.row[v]]);
    ASSERT_EQ(left_of_part[v], share[part.row[v]]);
    ASSERT_TRUE(of_part.scatter[v] == scatter[part.row[v]] || (std::isnan(of_part.scatter[v]) && std::isnan(scatter[part.row[v]])));
    ++compared;
  }
  EXPECT_GT(compared, 1000u);
}

TEST(Smoothing, WhatIsReadIsTheSameWhereOnlyThatCounts) {
  const core::Block b = noisy(12000, scarp, 0.05, 5);
  const Rectangle where{25.0, 25.0, 35.0, 35.0};
  Tin whole = tin_of(b), part = whole;
  const std::vector<double> before = whole.z;
  const Smoothed of_whole = smooth_heights(whole, b.size(), 1.0), of_part = smooth_heights(part, b.size(), 1.0, where);
  size_t compared = 0;
  for (const auto& t : whole.triangles) {
    const auto touches = [&](const std::vector<double>& at, double low, double high) {
      const auto [least, most] = std::minmax({at[t[0]], at[t[1]], at[t[2]]});
      return most >= low && least <= high;
    };
    if (!touches(whole.x, where.west, where.east) || !touches(whole.y, where.south, where.north)) continue;
    ++compared;
    for (const std::int32_t v : t) {
      ASSERT_EQ(part.z[v], whole.z[v]);
      ASSERT_EQ(of_part.left[v], of_whole.left[v]);
      ASSERT_EQ(std::isnan(of_part.scatter[v]), std::isnan(of_whole.scatter[v]));
      if (!std::isnan(of_whole.scatter[v])) {
        ASSERT_EQ(of_part.scatter[v], of_whole.scatter[v]);
      }
    }
  }
  EXPECT_GT(compared, 600u);
  size_t kept = 0;
  for (size_t v = 0; v < before.size(); ++v) kept += part.z[v] == before[v] && whole.z[v] != before[v];
  EXPECT_GT(kept, before.size() / 2);
}

}  // namespace
}  // namespace swath::terrain
