// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/wire_directions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace swath::filters {
namespace {

constexpr float near_line = 0.5f, steepest = 0.58f, far_away = 7.25f;
using Place = std::array<float, 3>;

/// Neighbours within near_line of the line through the origin and `to`; the farthest of them in plan.
std::pair<int, float> in_line(const std::vector<Place>& around, const Place& to) {
  const float run = std::hypot(to[0], to[1]), east = to[0] / run, north = to[1] / run, rise = to[2] / run;
  int n = 0;
  float far = 0;
  for (const Place& q : around) {
    const float u = east * q[0] + north * q[1], v = east * q[1] - north * q[0], w = q[2] - rise * u;
    if (v * v + w * w > near_line * near_line) continue;
    ++n;
    far = std::max(far, std::abs(u));
  }
  return {n, far};
}

std::uint16_t add(WireDirections& directions, float x, float y, float z) {
  std::uint16_t bin = 0;
  directions.add(&x, &y, &z, 1, &bin);
  return bin;
}

TEST(WireDirections, NoLineWithEnoughNeighboursIsMissedAndMostOthersAreDropped) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> across(-20.0f, 20.0f), up(-6.0f, 6.0f);
  int lines = 0, kept = 0, others = 0;
  for (int cloud = 0; cloud < 400; ++cloud) {
    std::vector<Place> around(60);
    for (Place& q : around) q = {across(random), across(random), up(random)};
    const Place& end = around[0];
    for (size_t k = 1; k < 6; ++k)  // in line with it, on both sides
      for (size_t axis = 0; axis < 3; ++axis) around[k][axis] = (0.4f * static_cast<float>(k) - 1.1f) * end[axis] + 0.01f * across(random);
    WireDirections directions(near_line, steepest, far_away);
    directions.clear();
    std::array<std::vector<float>, 3> places;
    for (const Place& q : around)
      for (size_t axis = 0; axis < 3; ++axis) places[axis].push_back(q[axis]);
    std::vector<std::uint16_t> bins(around.size());
    directions.add(places[0].data(), places[1].data(), places[2].data(), around.size(), bins.data());
    for (size_t k = 0; k < around.size(); ++k) {
      const Place& q = around[k];
      const float run = std::hypot(q[0], q[1]);
      if (run < 4.0f || std::abs(q[2]) > steepest * run) continue;
      const auto [n, far] = in_line(around, q);
      const bool is_line = n >= 4 && far >= far_away + near_line;
      lines += is_line;
      if (is_line) {
        EXPECT_TRUE(directions.any() && directions.holds(bins[k])) << q[0] << " " << q[1] << " " << q[2];
        continue;
      }
      ++others;
      kept += directions.holds(bins[k]);
    }
  }
  EXPECT_GT(lines, 100);
  EXPECT_LT(kept, others / 2);
}

TEST(WireDirections, ALineAlongTheEndOfTheHalfTurnCountsOnBothSides) {
  WireDirections directions(near_line, steepest, far_away);
  directions.clear();
  std::vector<std::uint16_t> bins;
  for (const float x : {-9.0f, -6.0f, 5.0f, 8.0f}) bins.push_back(add(directions, x, x > 0.0f ? 0.1f : -0.1f, 0.4f * x));
  EXPECT_TRUE(directions.any());
  EXPECT_TRUE(directions.holds(bins[0]));
  EXPECT_TRUE(directions.holds(bins[3]));
  EXPECT_TRUE(directions.holds(add(directions, 8.0f, -0.05f, 3.2f)));  // the other end of the half turn
  EXPECT_FALSE(directions.holds(add(directions, 8.0f, 0.1f, -3.2f)));
  EXPECT_FALSE(directions.holds(add(directions, 0.1f, 8.0f, 3.2f)));
}

TEST(CrossSection, CountsEachCellOnceAndHoldsTheRimOfTheTube) {
  CrossSection cells;
  EXPECT_EQ(cells.taken(), 0u);
  cells.add(0.6, 0.1);
  cells.add(0.9, 0.4);
  EXPECT_EQ(cells.taken(), 1u);
  cells.add(-clear_tube, clear_tube);
  cells.add(clear_tube, clear_tube);
  EXPECT_EQ(cells.taken(), 3u);
}

}  // namespace
}  // namespace swath::filters
