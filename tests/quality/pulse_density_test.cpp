// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/pulse_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

/// First returns of `line` over a box at `density`, a fifth of them with a second return.
void add_swath(core::Block& b, int line, double x0, double x1, double y1, double density, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(x0, x1), y(0.0, y1);
  const int n = static_cast<int>(density * (x1 - x0) * y1);
  for (int k = 0; k < n; ++k)
    for (int number = 1; number <= (k % 5 == 0 ? 2 : 1); ++number) {
      b.x.push_back(x(random)), b.y.push_back(y(random)), b.z.push_back(0.0);
      b.return_number.push_back(static_cast<std::uint8_t>(number));
      b.strip.push_back(static_cast<std::uint16_t>(line));
      b.flags.push_back(0);
    }
}

PulseCells counted(const core::Block& b, double x1, double y1) { return count_pulses(b, core::lattice_of(5.0, -20.0, -20.0, x1, y1)); }

/// 200 x 200 m at 4 and 2 per m2 over half of it: each line's density is right to 1 % (80 000 and 40 000 pulses: 0.4, 0.5 %), the rims of
/// the swaths do not lower it.
TEST(PulseDensity, OfEachLineAndOfAll) {
  core::Block b;
  add_swath(b, 3, 0.0, 201.0, 198.0, 4.0, 1);
  add_swath(b, 8, 103.0, 203.0, 198.0, 2.0, 2);
  const PulseCells cells = counted(b, 220, 220);
  const SwathDensity d = judge_density(cells.lines, cells.bins, 5.0);
  ASSERT_EQ(d.lines.size(), 2u);
  EXPECT_EQ(d.lines[0].line, 3);
  EXPECT_NEAR(d.lines[0].density, 4.0, 0.04);
  EXPECT_NEAR(d.lines[1].density, 2.0, 0.03);
  EXPECT_NEAR(d.lines[1].spacing, std::sqrt(0.5), 0.01);
  EXPECT_NEAR(d.single_density, d.lines[1].density, 1e-12);
  EXPECT_NEAR(d.all.density, 5.0, 0.15);  // half of the area with 4, half with 6
  EXPECT_NEAR(d.median, 5.0, 1.3);
  EXPECT_GT(d.high, 5.5);
  EXPECT_LT(d.low, 4.5);
  const core::Lattice& l = cells.density.lattice;
  EXPECT_EQ(cells.density.count[l.at(10, 20)], 1u);
  EXPECT_EQ(cells.density.count[l.at(35, 20)], 2u);
  EXPECT_EQ(cells.density.reason[l.at(0, 0)], core::Void::no_data);
  EXPECT_GE(cells.density.height[l.at(35, 20)], cells.single.height[l.at(35, 20)]);
}

TEST(PulseDensity, OfACorridorWithoutInnerCellsAllCellsCount) {
  core::Block b;
  add_swath(b, 1, 0.0, 5.0, 200.0, 8.0, 1);
  const PulseCells cells = counted(b, 220, 220);
  EXPECT_NEAR(judge_density(cells.lines, cells.bins, 5.0).all.density, 8.0, 0.1);
}

TEST(PulseDensity, TilesMakeTheWhole) {
  core::Block b;
  add_swath(b, 1, 0.0, 200.0, 200.0, 3.0, 4);
  const PulseCells whole = counted(b, 220, 220);
  PulseCells parts;
  for (const double x : {-20.0, 100.0}) {
    const PulseCells part = count_pulses(b, core::lattice_of(5.0, x, -20.0, x + 120.0, 220.0));
    parts.lines.insert(parts.lines.end(), part.lines.begin(), part.lines.end());
    parts.bins.insert(parts.bins.end(), part.bins.begin(), part.bins.end());
  }
  const SwathDensity a = judge_density(whole.lines, whole.bins, 5.0), c = judge_density(parts.lines, parts.bins, 5.0);
  EXPECT_EQ(a.all.pulses, c.all.pulses);
  EXPECT_EQ(a.all.density, c.all.density);
  EXPECT_EQ(a.median, c.median);
  for (const SwathDensity* d : {&a, &c}) {
    EXPECT_EQ(d->extent.x0, 0.0);
    EXPECT_EQ(d->extent.y0, 0.0);
    EXPECT_EQ(d->extent.x1, 200.0);
    EXPECT_EQ(d->extent.y1, 200.0);
  }
}

TEST(PulseDensity, OfManyLinesOneIsTheSparsest) {
  std::vector<PulseSums> lines{{all_lines, 2400, 121000}};
  for (int line = 1; line <= 120; ++line) lines.push_back({line, 20, line == 7 ? 400u : line == 9 ? 50u : 1000u});
  EXPECT_NEAR(judge_density(lines, {}, 5.0).single_density, 400.0 / (20 * 25.0), 1e-12) << "line 9 has hardly any";
}

TEST(PulseDensity, OfNothingThereIsNone) {
  const PulseCells cells = counted(core::Block(), 100, 100);
  const SwathDensity d = judge_density(cells.lines, cells.bins, 5.0);
  EXPECT_EQ(d.all.pulses, 0u);
  EXPECT_TRUE(d.lines.empty());
}

}  // namespace
}  // namespace swath::quality
