// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/building_sides.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

constexpr double tolerance = 0.15, lowest_roof = 2.0;  // m

/// A roof of 10 m by 8 m that rises by a half, its last 2 m in x not known to be roof; the ground lies at 0.
struct House {
  core::Block block;
  std::vector<std::uint8_t> roof;
  std::vector<std::uint8_t> sides() const {
    core::Block b = block;
    b.height.assign(b.z.begin(), b.z.end());
    return building_sides(b, roof, std::vector<std::uint8_t>(b.size(), 1), tolerance, lowest_roof, b.size());
  }
  size_t add(double x, double y, double z) {
    test::add_point(block, x, y, z);
    roof.push_back(0);
    return block.size() - 1;
  }
};
House house() {
  House h;
  for (double y = 0.0; y < 8.0; y += 0.5)
    for (double x = 0.0; x < 10.0; x += 0.5) {
      h.add(x, y, 5.0 + 0.5 * y + 0.02 * std::sin(17.0 * x + 11.0 * y));
      h.roof.back() = x < 8.0;
    }
  return h;
}

TEST(BuildingSides, TheRestOfARoofAndItsWallsAreTaken) {
  House h = house();
  const size_t wall = h.add(3.0, -0.4, 2.0);
  const std::vector<std::uint8_t> sides = h.sides();
  for (size_t p = 0; p < wall; ++p) EXPECT_EQ(sides[p], !h.roof[p]) << h.block.x[p] << " " << h.block.y[p];
  EXPECT_TRUE(sides[wall]);
}

TEST(BuildingSides, WhatStandsOverBesideOrFarIsNot) {
  House h = house();
  const size_t over = h.add(4.0, 4.0, 9.0), beside = h.add(3.0, -1.6, 2.0), far = h.add(15.0, 4.0, 7.0), under = h.add(11.5, 4.0, 3.0);
  const size_t first = h.add(3.0, -0.4, 2.5);
  core::add_columns(h.block, {core::Column::return_number, core::Column::return_count});
  h.block.return_number[first] = 1, h.block.return_count[first] = 2;
  const std::vector<std::uint8_t> sides = h.sides();
  for (const size_t p : {over, beside, far, under, first}) EXPECT_FALSE(sides[p]) << p;
}

TEST(BuildingSides, TheFootOfAWallLiesCloseAndUnderAHighRoof) {
  House h = house();
  const size_t foot = h.add(3.0, -0.5, 0.8), hedge = h.add(5.0, -0.9, 0.8), wall = h.add(6.5, -0.9, 3.0);
  const std::vector<std::uint8_t> sides = h.sides();
  EXPECT_TRUE(sides[foot]);
  EXPECT_FALSE(sides[hedge]);
  EXPECT_TRUE(sides[wall]);
  House shed = house();
  for (double& z : shed.block.z) z = 2.2;
  const size_t beside = shed.add(3.0, -0.3, 0.8);
  EXPECT_FALSE(shed.sides()[beside]);
}

TEST(BuildingSides, DoNotDependOnTheOrder) {
  House h = house();
  const std::vector<std::uint8_t> whole = h.sides();
  std::vector<std::uint32_t> rows;
  House other{test::shuffled(h.block, 3, rows), {}};
  for (const std::uint32_t r : rows) other.roof.push_back(h.roof[r]);
  const std::vector<std::uint8_t> again = other.sides();
  for (size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(again[k], whole[rows[k]]);
}

}  // namespace
}  // namespace swath::filters
