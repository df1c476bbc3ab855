// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/wire_neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace swath::filters {
namespace {

constexpr double radius = 25.0;

WireNeighbours around_first(const core::Block& b) {
  const Bins bins(b, radius / wire::bins_of_reach, 0, [](size_t) { return true; });
  WireNeighbours found;
  found.find(bins, b, 0, radius);
  return found;
}

void add(core::Block& b, double x, double y, double z) { b.x.push_back(x), b.y.push_back(y), b.z.push_back(z); }

/// Places every 2 m on a line that rises, `n` on each side of the first.
core::Block line_of(int n) {
  core::Block b;
  add(b, 0, 0, 0);
  for (int k = 1; k <= n; ++k)
    for (const int side : {-1, 1}) add(b, 1.6 * k * side, 1.2 * k * side, 0.4 * k * side);
  return b;
}

size_t wires(const WireNeighbours& around) {
  size_t n = 0;
  for (size_t k = 0; k < around.size(); ++k) n += around.is_line(k) && around.may_be_wire(k);
  return n;
}

TEST(WireNeighbours, OnlyTheNearestOfManyAreLookedAt) {
  core::Block b;
  add(b, 0, 0, 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-12.0, 12.0);
  for (int k = 0; k < 3000; ++k) add(b, at(random), at(random), at(random));
  std::vector<double> distances;
  for (size_t p = 1; p < b.size(); ++p) distances.push_back(std::hypot(b.x[p], b.y[p], b.z[p]));
  std::sort(distances.begin(), distances.end());
  const WireNeighbours around = around_first(b);
  ASSERT_EQ(around.size(), 96u);
  double farthest = 0;
  for (size_t k = 0; k < around.size(); ++k) farthest = std::max(farthest, around[k].norm());
  EXPECT_NEAR(farthest, distances[95], 1e-5);
  EXPECT_TRUE(around.any_within(distances[0] + 1e-3));
  EXPECT_FALSE(around.any_within(distances[0] - 1e-3));
}

TEST(WireNeighbours, ALineIsFoundWhateverTheNumberOfPlacesOnIt) {
  for (int n = 4; n <= 10; ++n) {  // 8 to 20 neighbours: whole and broken batches
    const WireNeighbours around = around_first(line_of(n));
    ASSERT_EQ(around.size(), static_cast<size_t>(2 * n));
    EXPECT_EQ(wires(around), static_cast<size_t>(2 * (n - 3))) << n;  // the three on each side within 7 m give no direction
  }
}

TEST(WireNeighbours, TooShortALineIsNone) {
  const WireNeighbours around = around_first(line_of(3));
  EXPECT_EQ(wires(around), 0u);
  EXPECT_EQ(wires(around_first(line_of(2))), 0u);
}

TEST(WireNeighbours, ALineInFoliageIsNone) {
  core::Block b = line_of(6);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> turn(0.0, 6.283), off(0.75, 1.15), along(-6.0, 6.0);
  for (int k = 0; k < 60; ++k) {
    const double bearing = turn(random), r = off(random), u = along(random), v = r * std::cos(bearing);
    add(b, 0.8 * u - 0.6 * v, 0.6 * u + 0.8 * v, 0.2 * u + r * std::sin(bearing));
  }
  EXPECT_EQ(wires(around_first(b)), 0u);
}

TEST(WireNeighbours, FourNeighboursInLineMayCarryItOn) {
  core::Block b;
  add(b, 0, 0, 0);
  for (int k = 1; k <= 4; ++k) add(b, 3.0 * k, 0.1, 0.2 * k);
  EXPECT_TRUE(around_first(b).may_carry_on(3));
  b.y[2] = 3.0;
  EXPECT_FALSE(around_first(b).may_carry_on(3));
}

}  // namespace
}  // namespace swath::filters
