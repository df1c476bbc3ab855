// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/towers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/world/power_line.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

std::vector<std::uint8_t> towers(const core::Block& b, const std::vector<std::uint8_t>& truth, size_t own) {
  std::vector<std::uint8_t> wire, tall;
  for (size_t p = 0; p < b.size(); ++p) {
    wire.push_back(truth[p] == cls::wire);
    tall.push_back((truth[p] == test::tower_class || truth[p] == cls::high_vegetation) && b.height[p] >= 1.0f);
  }
  return tower_points(b, wire, tall, own);
}

TEST(Towers, MastsWithArmsAreFoundAndTreesBesideTheLineAreNot) {
  double all = 0, right = 0, wrong = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    test::LineOfWires o;
    o.seed = seed;
    const test::PowerLineScene s = test::make_power_line(o);
    const std::vector<std::uint8_t> found = towers(s.block, s.truth, s.block.size());
    for (size_t p = 0; p < found.size(); ++p) {
      const bool is = s.truth[p] == test::tower_class && s.block.height[p] >= 1.0f;
      all += is, right += is && found[p], wrong += !is && found[p];
    }
  }
  EXPECT_GE(right, 0.95 * all);
  EXPECT_LE(wrong, 0.02 * (right + wrong));
}

TEST(Towers, WithoutWiresAMastIsNone) {
  test::PowerLineScene s = test::make_power_line({});
  std::replace(s.truth.begin(), s.truth.end(), cls::wire, cls::unassigned);
  const std::vector<std::uint8_t> found = towers(s.block, s.truth, s.block.size());
  EXPECT_EQ(std::accumulate(found.begin(), found.end(), 0), 0);
}

TEST(Towers, WhatLiesBeyondTheHaloChangesNothing) {
  const test::PowerLineScene s = test::make_power_line({});
  const std::vector<std::uint8_t> whole = towers(s.block, s.truth, s.block.size());
  const double cut = s.pylons[1].x() + 0.3;  // through a mast
  std::vector<size_t> rows;
  for (const bool own : {true, false})
    for (size_t p = 0; p < s.block.size(); ++p)
      if (own ? s.block.x[p] < cut : s.block.x[p] >= cut && s.block.x[p] < cut + tower_points_halo()) rows.push_back(p);
  core::Block part;
  std::vector<std::uint8_t> truth;
  part.origin = s.block.origin;
  size_t own = 0, of_masts = 0;
  for (const size_t p : rows) {
    part.x.push_back(s.block.x[p]), part.y.push_back(s.block.y[p]), part.z.push_back(s.block.z[p]);
    part.height.push_back(s.block.height[p]);
    truth.push_back(s.truth[p]);
    own += s.block.x[p] < cut;
  }
  const std::vector<std::uint8_t> found = towers(part, truth, own);
  for (size_t k = 0; k < own; ++k) {
    EXPECT_EQ(found[k], whole[rows[k]]) << k;
    of_masts += found[k];
  }
  EXPECT_GT(of_masts, 20u);
}

}  // namespace
}  // namespace swath::filters
