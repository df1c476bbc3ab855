// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/hilbert_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace swath::terrain {
namespace {

TEST(HilbertOrder, NeighboursOnTheCurveAreNeighboursOnTheMap) {
  // One place per cell of the curve's own lattice, 64 of its cells apart: each step goes to a neighbour.
  std::vector<Place> places;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) places.push_back({10.0 + i + 0.5 / 64, 20.0 + j + 0.5 / 64});
  places.front() = {10.0, 20.0};
  places.push_back({74.0, 84.0});
  const auto order = along_hilbert_curve(places);
  std::vector<Place> path;
  for (const OnCurve& o : order)
    if (o.number < 64 * 64) path.push_back(places[o.number]);
  ASSERT_EQ(path.size(), 64u * 64u);
  for (size_t k = 1; k < path.size(); ++k) ASSERT_NEAR(std::abs(path[k].x - path[k - 1].x) + std::abs(path[k].y - path[k - 1].y), 1.0, 0.1);
}

TEST(HilbertOrder, EveryPlaceOnceAndEqualOnesTogether) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> part(0, 99);
  std::vector<Place> places;
  for (int k = 0; k < 5000; ++k) places.push_back({0.01 * part(random), 0.01 * part(random)});
  const auto order = along_hilbert_curve(places);
  std::set<std::uint32_t> seen;
  std::set<std::pair<double, double>> done;
  for (size_t k = 0; k < order.size(); ++k) {
    EXPECT_TRUE(seen.insert(order[k].number).second);
    if (k > 0) {
      EXPECT_TRUE(order[k - 1].cell < order[k].cell || (order[k - 1].cell == order[k].cell && order[k - 1].number < order[k].number));
    }
    const Place& p = places[order[k].number];
    if (k > 0 && order[k].cell == order[k - 1].cell) continue;
    EXPECT_TRUE(done.insert({p.x, p.y}).second);
  }
  EXPECT_EQ(seen.size(), places.size());
  EXPECT_TRUE(along_hilbert_curve({}).empty());
  EXPECT_EQ(along_hilbert_curve({{1, 1}, {1, 1}}).size(), 2u);
}

TEST(HilbertOrder, FromCoarseToFineEveryNumberOnceRowByRow) {
  EXPECT_EQ(from_coarse_to_fine(3, 8), (std::vector<std::int32_t>{3, 7, 5, 4, 6}));
  EXPECT_TRUE(from_coarse_to_fine(5, 5).empty());
  const auto order = from_coarse_to_fine(7, 10007);
  ASSERT_EQ(order.size(), 10000u);
  EXPECT_EQ(std::set<std::int32_t>(order.begin(), order.end()).size(), order.size());
  for (std::ptrdiff_t k = 0; k < 10000; ++k) ASSERT_EQ((order[static_cast<size_t>(k)] - 7) / 4096, k / 4096);
}

}  // namespace
}  // namespace swath::terrain
