// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/line_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/statistics.h"

namespace swath::quality {
namespace {

using core::Block;

/// Returns of lines 1, 2, ... over a square, each with its own offset and white noise.
struct Flown {
  double side = 128.0, density = 8.0, noise = 0.02, slope = 0.1;
  std::vector<double> offsets{0.0, 0.1};

  Block points(unsigned seed = 1) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0.0, side);
    std::normal_distribution<double> error(0.0, noise);
    Block b;
    b.origin = {500000.0, 5300000.0, 0.0};
    for (size_t line = 0; line < offsets.size(); ++line)
      for (int k = 0; k < static_cast<int>(density * side * side); ++k) {
        b.x.push_back(place(random));
        b.y.push_back(place(random));
        b.z.push_back(300.0 + slope * b.x.back() + offsets[line] + error(random));
        b.strip.push_back(static_cast<std::uint16_t>(line + 1));
      }
    return b;
  }
};

double median_difference(const LineCells& c, int level) {
  std::vector<double> d;
  for (const LineDifference& one : c.differences)
    if (one.level == level) d.push_back(one.difference);
  return core::median(d);
}

TEST(LineCells, TwoLinesDifferByTheirOffset) {
  const Flown f;
  const Block b = f.points();
  const LineCells c = compare_cells(b, b.size(), {});
  ASSERT_EQ(c.differences.front().line_a, 1);
  ASSERT_EQ(c.differences.front().line_b, 2);
  for (int level = 0; level < 3; ++level) EXPECT_NEAR(median_difference(c, level), -0.1, 0.002) << level;
}

TEST(LineCells, ScatterIsTheReturnsOwnError) {
  for (const double noise : {0.01, 0.03}) {
    Flown f;
    f.noise = noise;
    f.slope = 0.0;
    const Block b = f.points();
    std::vector<double> sigmas;
    for (const LineScatter& s : compare_cells(b, b.size(), {}).scatters)
      if (s.level == 0) sigmas.push_back(s.sigma);
    EXPECT_NEAR(core::median(sigmas), noise, 0.03 * noise);
  }
}

TEST(LineCells, RoughGroundAndCliffsAreNotCompared) {
  Flown rough;
  rough.noise = 0.5;
  EXPECT_TRUE(compare_cells(rough.points(), rough.points().size(), {}).differences.empty());
  Flown cliff;
  cliff.slope = 2.0;
  EXPECT_TRUE(compare_cells(cliff.points(), cliff.points().size(), {}).differences.empty());
}

TEST(LineCells, SteepGroundIsComparedApart) {
  for (const double slope : {0.6, -0.6, 0.1}) {
    Flown f;
    f.slope = slope;
    const LineCells c = compare_cells(f.points(), f.points().size(), {});
    ASSERT_FALSE(c.differences.empty());
    for (const LineDifference& d : c.differences) {
      EXPECT_EQ(d.aspect, slope == 0.1 ? 0 : slope < 0.0 ? 1 : 3);  // falls east, west
      EXPECT_NEAR(d.slope, std::abs(slope), 0.05);
    }
    ASSERT_FALSE(c.scatters.empty());
    EXPECT_NEAR(c.scatters.front().sigma, f.noise, 0.3 * f.noise);
  }
}

TEST(LineCells, SparseLinesAreComparedInWiderCells) {
  Flown f;
  f.density = 0.5;  // 2, 8 and 32 returns of a line in a cell
  f.side = 512.0;
  const Block b = f.points();
  const LineCells c = compare_cells(b, b.size(), {});
  EXPECT_EQ(std::count_if(c.differences.begin(), c.differences.end(), [](const LineDifference& d) { return d.level == 0; }), 0);
  EXPECT_NEAR(median_difference(c, 2), -0.1, 0.003);
}

TEST(LineCells, EarlyReturnsNoiseAndWithheldPointsDoNotCount) {
  const Flown f;
  Block b = f.points();
  const LineCells clean = compare_cells(b, b.size(), {});
  const size_t n = b.size();
  const Block more = f.points(2);
  core::add_columns(b, {core::Column::return_number, core::Column::return_count, core::Column::classification, core::Column::flags});
  std::fill(b.return_number.begin(), b.return_number.end(), std::uint8_t{1});
  std::fill(b.return_count.begin(), b.return_count.end(), std::uint8_t{1});
  core::append(b, more);
  for (size_t p = n; p < b.size(); ++p) {
    b.z[p] += 5.0;
    b.return_number[p] = static_cast<std::uint8_t>(p % 3 == 0 ? 2 : 1);
    b.return_count[p] = static_cast<std::uint8_t>(p % 3 == 0 ? 2 : 1);
    if (p % 3 == 1) b.classification[p] = core::point_class::high_noise;
    if (p % 3 == 2) b.flags[p] = core::flag::withheld;
  }
  const LineCells c = compare_cells(b, b.size(), {});
  EXPECT_EQ(c.differences, clean.differences);
  EXPECT_EQ(c.scatters, clean.scatters);
}

TEST(LineCells, TilesThatShareABlockAgreeToTheLastBit) {
  const Flown f;
  const Block whole = f.points();
  const LineCells expected = compare_cells(whole, whole.size(), {});
  // West of x = 50 first, the rest as halo, shuffled: blocks are 32 m wide.
  std::vector<std::uint32_t> rows(whole.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::shuffle(rows.begin(), rows.end(), std::mt19937(3));
  const auto own = std::stable_partition(rows.begin(), rows.end(), [&](std::uint32_t p) { return whole.x[p] < 50.0; });
  const Block tile = core::select(whole, rows);
  const LineCells west = compare_cells(tile, static_cast<size_t>(own - rows.begin()), {});
  ASSERT_FALSE(west.differences.empty());
  EXPECT_LT(west.differences.size(), expected.differences.size());
  for (const LineDifference& d : west.differences) EXPECT_EQ(std::count(expected.differences.begin(), expected.differences.end(), d), 1);
  for (const LineScatter& s : west.scatters) EXPECT_EQ(std::count(expected.scatters.begin(), expected.scatters.end(), s), 1);
}

}  // namespace
}  // namespace swath::quality
