// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/river.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "terrain/tin/tin_surface.h"
#include "tests/terrain/tin/heights_at.h"

namespace swath::terrain {
namespace {

using Eigen::Vector3d;

constexpr double width = 8.0, river_length = 300.0;  // m

/// Middle of a meandering river at s of 0 .. 1, and its direction.
std::pair<Eigen::Vector2d, Eigen::Vector2d> middle(double s) {
  const double x = river_length * s, a = 25.0, w = 2.0 * M_PI / 120.0;
  return {{x, a * std::sin(w * x)}, Eigen::Vector2d(1.0, a * w * std::cos(w * x)).normalized()};
}

/// Outline: one bank out, the other back.
std::vector<Vector3d> meander() {
  std::vector<Vector3d> ring;
  constexpr int n = 150;
  for (int side : {1, -1})
    for (int k = 0; k <= n; ++k) {
      const double s = static_cast<double>(side > 0 ? k : n - k) / n;
      const auto [p, d] = middle(s);
      ring.emplace_back(p.x() - side * 0.5 * width * d.y(), p.y() + side * 0.5 * width * d.x(), 20.0 - 5.0 * s);
    }
  return ring;
}

bool is_monotone(const std::vector<Vector3d>& ring, const std::vector<size_t>& bank) {
  bool up = true, down = true;
  for (size_t k = 1; k < bank.size(); ++k) {
    up = up && ring[bank[k]].z() >= ring[bank[k - 1]].z() - 1e-12;
    down = down && ring[bank[k]].z() <= ring[bank[k - 1]].z() + 1e-12;
  }
  return up || down;
}

TEST(River, SampledRingKeepsItsVertices) {
  const auto ring = meander();
  const auto dense = sampled_ring(ring, 0.5);
  for (const Vector3d& v : ring) EXPECT_TRUE(std::any_of(dense.begin(), dense.end(), [&](const Vector3d& d) { return d == v; }));
  for (size_t k = 0; k < dense.size(); ++k) EXPECT_LE((dense[(k + 1) % dense.size()] - dense[k]).head<2>().norm(), 0.5 + 1e-9);
}

TEST(River, RungsSpanTheWidthThroughTheBends) {
  const auto ring = sampled_ring(meander(), 1.0);
  const Banks b = banks_of(ring);
  // Ends within a width of the true ends.
  for (const size_t v : {b.left.front(), b.left.back()})
    EXPECT_LT(std::min((ring[v].head<2>() - middle(0).first).norm(), (ring[v].head<2>() - middle(1).first).norm()), width);
  double widest = 0;
  for (const auto& [i, j] : b.rungs) widest = std::max(widest, (ring[b.left[i]] - ring[b.right[j]]).head<2>().norm());
  EXPECT_LT(widest, 1.5 * width);
  for (size_t k = 1; k < b.rungs.size(); ++k) {
    EXPECT_LE(b.rungs[k].first - b.rungs[k - 1].first, 1u);
    EXPECT_LE(b.rungs[k].second - b.rungs[k - 1].second, 1u);
  }
  EXPECT_EQ(b.rungs.back(), (std::pair{b.left.size() - 1, b.right.size() - 1}));
}

TEST(River, MonotoneIsTheLeastSquaresSolution) {
  double sum = 0;
  const std::vector<double> v{5, 4, 4.4, 2, 1}, one(5, 1.0);
  monotone(v, one, true, &sum);
  EXPECT_NEAR(sum, 2 * 0.2 * 0.2, 1e-12);
  const auto m = monotone({5, 0, 3}, {1, 0, 1}, true);
  EXPECT_NEAR(m[1], 4.0, 1e-12);
  const auto up = monotone({1, 3, 2, 4}, {1, 1, 1, 1}, false);
  EXPECT_TRUE(std::is_sorted(up.begin(), up.end()));
}

TEST(River, FallingBanksAreLeftAndRisesMended) {
  auto ring = sampled_ring(meander(), 1.0);
  const auto before = ring;
  const Banks b = banks_of(ring);
  auto kept = ring;
  make_banks_fall(kept, b);
  double most = 0;
  for (size_t k = 0; k < kept.size(); ++k) most = std::max(most, std::abs(kept[k].z() - before[k].z()));
  EXPECT_LT(most, 0.15);  // at the ends alone, where the outline's short side is cut in its middle
  for (size_t k = 40; k < 60; ++k) ring[k].z() += 2.0;
  make_banks_fall(ring, b);
  EXPECT_TRUE(is_monotone(ring, b.left));
  EXPECT_TRUE(is_monotone(ring, b.right));
}

TEST(River, LevelsFromRungsAreMonotoneAndCloseToTheTruth) {
  auto ring = sampled_ring(meander(), 1.0);
  const Banks b = banks_of(ring);
  std::vector<double> value, weight;
  unsigned r = 1;
  for (const auto& [i, j] : b.rungs) {
    r = r * 1664525u + 1013904223u;
    value.push_back(0.5 * (ring[b.left[i]].z() + ring[b.right[j]].z()) + 0.1 * (static_cast<double>(r >> 8) / (1u << 24) - 0.5));
    weight.push_back(value.size() % 7 == 0 ? 0.0 : 1.0);
  }
  const auto truth = ring;
  level_across(ring, b, value, weight);
  EXPECT_TRUE(is_monotone(ring, b.left));
  EXPECT_TRUE(is_monotone(ring, b.right));
  double square = 0;
  for (size_t k = 0; k < ring.size(); ++k) square += (ring[k].z() - truth[k].z()) * (ring[k].z() - truth[k].z());
  EXPECT_LT(std::sqrt(square / static_cast<double>(ring.size())), 0.06);  // noise of 0.03 and the tilt of rungs in bends
}

TEST(River, SurfaceFallsAlongTheMiddle) {
  const auto ring = sampled_ring(meander(), 1.0);
  const Tin tin = river_surface(ring, banks_of(ring));
  std::vector<double> x, y;
  for (int k = 3; k <= 97; ++k) {
    x.push_back(middle(0.01 * k).first.x());
    y.push_back(middle(0.01 * k).first.y());
  }
  const auto z = heights_at(tin, x, y);
  for (size_t k = 0; k < z.size(); ++k) EXPECT_NEAR(z[k], 20.0 - 0.05 * (static_cast<double>(k) + 3.0), 0.12);
  for (size_t k = 1; k < z.size(); ++k) EXPECT_LE(z[k], z[k - 1] + 1e-9);
}

}  // namespace
}  // namespace swath::terrain
