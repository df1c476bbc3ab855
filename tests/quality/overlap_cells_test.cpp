// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/overlap_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

constexpr double side = 60.0, noise = 0.02;

/// Three lines over a square of slope `slope`, the second `shift` m higher than the first, the third over half of it only.
core::Block three_lines(double shift, double slope = 0.05, float sigma = 0.0F, double density = 8.0) {
  core::Block b;
  b.origin = {1000, 2000, 0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, side);
  std::normal_distribution<double> error(0.0, noise);
  for (int line = 1; line <= 3; ++line)
    for (int k = 0; k < static_cast<int>(density * side * side); ++k) {
      const double x = place(random), y = place(random);
      if (line == 3 && x > 0.5 * side) continue;
      b.x.push_back(x), b.y.push_back(y);
      b.z.push_back(300.0 + slope * x + (line == 2 ? shift : 0.0) + error(random));
      b.strip.push_back(static_cast<std::uint16_t>(line));
      b.sigma_v.push_back(sigma);
    }
  return b;
}

core::Lattice window(double cell = 2.0) { return core::lattice_of(cell, 1000, 2000, 1000 + side, 2000 + side); }

/// 900 cells of 32 returns with 2 cm each: the mean difference has a sigma of 2 cm sqrt(2/32/900) = 0.2 mm, the bins half of 0.5 mm.
TEST(OverlapCells, ShiftsAreRecoveredToTwoMillimetres) {
  for (const double shift : {0.0, 0.02, 0.05, 0.10, -0.05}) {
    const SwathOverlaps o = judge_overlaps(compare_overlaps(three_lines(shift), window(), {}));
    ASSERT_EQ(o.pairs.size(), 3u);
    EXPECT_EQ(o.pairs[0].line_a, 1);
    EXPECT_EQ(o.pairs[0].line_b, 2);
    EXPECT_NEAR(o.pairs[0].mean, -shift, 0.002) << shift;
    EXPECT_NEAR(o.pairs[0].median, -shift, 0.002) << shift;
    EXPECT_NEAR(o.pairs[1].median, 0.0, 0.002);    // 1 and 3
    EXPECT_NEAR(o.pairs[2].median, shift, 0.002);  // 2 and 3
    EXPECT_NEAR(o.pairs[0].rms, std::hypot(shift, noise * std::sqrt(2.0 / 32)), 0.002);
    EXPECT_GT(o.pairs[0].q95, std::abs(shift));
    EXPECT_LT(o.pairs[0].cells, 901u);
    EXPECT_GT(o.pairs[0].cells, 850u);
    EXPECT_EQ(o.all.cells, o.pairs[0].cells + o.pairs[1].cells + o.pairs[2].cells);
    EXPECT_LE(o.pairs[1].east, 1000 + 0.5 * side);
    EXPECT_GT(o.pairs[0].east, 1000 + 0.9 * side);
  }
}

TEST(OverlapCells, ScatterIsThatOfTheReturns) {
  const SwathOverlaps o = judge_overlaps(compare_overlaps(three_lines(0.0), window(), {}));
  ASSERT_EQ(o.lines.size(), 3u);
  for (const SwathLine& l : o.lines) {
    EXPECT_NEAR(l.rms, noise, 0.02 * noise) << l.line;
    EXPECT_NEAR(l.hard, noise, 0.06 * noise) << l.line;  // of a quartile of 900 cells, and of its approximation
  }
  EXPECT_NEAR(o.hard, noise, 0.05 * noise);
}

TEST(OverlapCells, TheImageHasTheLargestDifference) {
  const OverlapCells c = compare_overlaps(three_lines(0.10), window(), {});
  const core::Lattice& l = c.difference.lattice;
  double west = 0.0, east = 0.0;
  for (int j = 2; j < 28; ++j) {
    west += std::abs(static_cast<double>(c.difference.height[l.at(5, j)])) / 26;
    east += static_cast<double>(c.difference.height[l.at(25, j)]) / 26;
    EXPECT_EQ(c.difference.count[l.at(5, j)], 3u);
    EXPECT_EQ(c.difference.count[l.at(25, j)], 2u);
  }
  EXPECT_NEAR(east, -0.10, 0.005);
  EXPECT_NEAR(west, 0.10, 0.01);
}

/// Lines whose shared error has 3 cm and returns with 2 cm: with the true sigma of a return, sqrt(13) cm, the difference of 1 and 2 is
/// predicted as 3 cm sqrt(2) and a little white noise.
TEST(OverlapCells, PredictedIsTheSharedPart) {
  const float sigma = 0.0360555F;
  const SwathOverlaps o = judge_overlaps(compare_overlaps(three_lines(0.04, 0.05, sigma), window(), {}));
  EXPECT_NEAR(o.pairs[0].predicted, std::sqrt(2 * (0.0009 + 0.0004 / 32)), 0.0005);
  EXPECT_NEAR(o.pairs[0].error_over_sigma, o.pairs[0].rms / o.pairs[0].predicted, 1e-9);
  EXPECT_TRUE(std::isnan(judge_overlaps(compare_overlaps(three_lines(0.04), window(), {})).pairs[0].predicted));
}

TEST(OverlapCells, SteepGroundIsInTheImageAlone) {
  const OverlapCells c = compare_overlaps(three_lines(0.05, 0.5), window(), {});
  EXPECT_TRUE(c.pairs.empty());
  EXPECT_NEAR(static_cast<double>(c.difference.height[c.difference.lattice.at(25, 10)]), -0.05, 0.03);
  const SwathOverlaps o = judge_overlaps(c);
  EXPECT_EQ(o.all.cells, 0u);
  EXPECT_TRUE(std::isnan(o.hard));
}

TEST(OverlapCells, TilesMakeTheWhole) {
  const core::Block b = three_lines(0.05);
  const SwathOverlaps whole = judge_overlaps(compare_overlaps(b, window(), {}));
  OverlapCells parts;
  for (const double x : {1000.0, 1030.0}) {
    const OverlapCells p = compare_overlaps(b, core::lattice_of(2.0, x, 2000, x + 30, 2000 + side), {});
    parts.pairs.insert(parts.pairs.end(), p.pairs.begin(), p.pairs.end());
    parts.bins.insert(parts.bins.end(), p.bins.begin(), p.bins.end());
    parts.lines.insert(parts.lines.end(), p.lines.begin(), p.lines.end());
    parts.line_bins.insert(parts.line_bins.end(), p.line_bins.begin(), p.line_bins.end());
  }
  const SwathOverlaps joined = judge_overlaps(parts);
  ASSERT_EQ(joined.pairs.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(joined.pairs[k].cells, whole.pairs[k].cells);
    EXPECT_NEAR(joined.pairs[k].median, whole.pairs[k].median, 1e-9);
    EXPECT_EQ(joined.pairs[k].east, whole.pairs[k].east);
  }
  EXPECT_NEAR(joined.hard, whole.hard, 1e-9);
}

}  // namespace
}  // namespace swath::quality
