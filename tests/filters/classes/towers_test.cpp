// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/towers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/classes/wires.h"
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

/// A wire 20 m above level ground along x through (0, 0), and what stands there; `found`: 1 for what is of a support.
struct Stand {
  core::Block b;
  std::vector<std::uint8_t> wire, tall;
  void add(double x, double y, double z, bool is_wire) {
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(z), b.height.push_back(static_cast<float>(z));
    wire.push_back(is_wire), tall.push_back(!is_wire);
  }
  Stand() {
    for (double x = -30.0; x <= 30.0; x += 1.5) add(x, 2.0, 20.0, true);
  }
  std::vector<std::uint8_t> found() const { return tower_points(b, wire, tall, b.x.size()); }
  size_t count() const {
    const auto f = found();
    return static_cast<size_t>(std::accumulate(f.begin(), f.end(), 0));
  }
};

TEST(Towers, APoleOfFewReturnsIsFoundAndABushUnderAStrayReturnIsNot) {
  Stand pole, bush, low;
  for (const double z : {4.0, 8.5, 12.0}) pole.add(0.2 * std::sin(z), 0.2 * std::cos(z), z, false);
  EXPECT_EQ(pole.count(), 3u);
  for (int k = 0; k < 20; ++k) bush.add(1.2 * std::sin(k), 1.2 * std::cos(k), 2.0 + 0.1 * k, false);
  bush.add(0.3, 0.0, 19.5, false);  // near the wire, and not on it
  EXPECT_EQ(bush.count(), 0u);
  for (const double z : {2.5, 5.0, 8.0}) low.add(0.0, 0.1, z, false);  // 12 m below the wire
  EXPECT_EQ(low.count(), 0u);
}

TEST(Towers, ABirdAboveAndABushAtItsFootAreNotOfTheMast) {
  Stand s;
  for (double z = 6.0; z <= 20.5; z += 1.5) s.add(0.25 * std::sin(9.0 * z), 0.25 * std::cos(9.0 * z), z, false);
  const size_t mast = s.b.x.size();
  s.add(0.5, 0.5, 60.0, false);
  for (int k = 0; k < 12; ++k) s.add(1.6 + 0.2 * std::sin(k), 0.8 * std::cos(k), 2.5, false);
  const std::vector<std::uint8_t> found = s.found();
  for (size_t p = 0; p < found.size(); ++p)
    if (p >= mast || s.tall[p]) {
      EXPECT_EQ(found[p] != 0, p < mast) << s.b.x[p] << " " << s.b.y[p] << " " << s.b.z[p];
    }
}

/// 1 m wide, up to 22 m, with arms of lattice `wide` to both sides of their axis.
void add_lattice(Stand& s, double wide) {
  for (int k = 0; k < 300; ++k) s.add(0.5 * std::sin(7.0 * k), 0.5 * std::cos(5.0 * k), 2.0 + k / 15.0, false);
  for (int k = 0; k < 240; ++k) s.add(wide * std::sin(3.0 * k), -6.0 + k / 20.0, 21.0 + 0.4 * std::cos(2.0 * k), false);
}

TEST(Towers, DenseWiresAndWideArmsAreNoCrown) {
  Stand s;
  add_lattice(s, 0.9);
  const size_t end = s.b.x.size();
  for (const double y : {-3.0, 0.0, 3.0})
    for (double x = -4.5; x <= 4.5; x += 0.1) s.add(x, y, 20.0, false);
  EXPECT_EQ(s.count(), 0u);
  std::fill(s.wire.begin() + static_cast<std::ptrdiff_t>(end), s.wire.end(), wire_at_support);
  const std::vector<std::uint8_t> found = s.found();
  size_t mast = 0, wires = 0;
  for (size_t p = 0; p < found.size(); ++p) (p < end ? mast : wires) += found[p] == (p < end ? 1 : 2);
  EXPECT_GE(mast, 500u);
  EXPECT_GE(wires, 180u);  // but for those within the mast
}

TEST(Towers, ACrownInLineWithAWireIsNone) {
  Stand s;
  for (int k = 0; k < 800; ++k) {
    const double r = 3.5 * std::sqrt((k + 0.5) / 800.0);
    s.add(r * std::cos(2.4 * k), r * std::sin(2.4 * k), 12.0 + 8.0 * std::abs(std::sin(1.7 * k)), false);
    s.wire.back() = std::abs(s.b.y.back()) < 0.4 ? wire_at_support : std::uint8_t{0};
  }
  EXPECT_EQ(s.count(), 0u);
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
