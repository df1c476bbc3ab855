// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/line_offsets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace swath::quality {
namespace {

/// Blocks of two lines with this difference; `drift`: m, standard deviation of what changes from one stretch of 256 m to the next.
void overlap(LineCells& c, int a, int b, double difference, double drift = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0.0, drift > 0.0 ? drift : 1.0);
  for (int stretch = 0; stretch < 40; ++stretch) {
    const double now = difference + (drift > 0.0 ? error(random) : 0.0);
    for (int k = 0; k < 8; ++k) c.differences.push_back({0, 8 * stretch + k, 100 * a, a, b, 100, static_cast<float>(now), 0.01F});
  }
  for (const int line : {a, b}) c.scatters.push_back({0, 0, 100 * a, line, 100, 0.02F});
}

const LineOffset& of(const LineComparison& c, int line) {
  return *std::find_if(c.lines.begin(), c.lines.end(), [line](const LineOffset& l) { return l.line == line; });
}

TEST(LineOffsets, AreFoundWithTheirMeanKeptZero) {
  LineCells cells;
  overlap(cells, 1, 2, -0.10);
  overlap(cells, 2, 3, 0.05);
  overlap(cells, 1, 3, -0.05);
  const LineComparison c = compare_lines(cells, {});
  ASSERT_EQ(c.lines.size(), 3u);
  double sum = 0.0;
  for (const LineOffset& l : c.lines) sum += l.offset;
  EXPECT_NEAR(sum, 0.0, 1e-9);
  EXPECT_NEAR(of(c, 1).offset - of(c, 2).offset, -0.10, 1e-6);
  EXPECT_NEAR(of(c, 1).offset - of(c, 3).offset, -0.05, 1e-6);
  for (const LinePair& p : c.pairs) EXPECT_NEAR(p.rms_after, 0.0, 1e-6);
}

TEST(LineOffsets, LinesThatDoNotMeetAreGroupsOfTheirOwn) {
  LineCells cells;
  overlap(cells, 1, 2, 0.1);
  overlap(cells, 5, 6, -0.3);
  cells.scatters.push_back({0, 0, 0, 9, 100, 0.02F});
  const LineComparison c = compare_lines(cells, {});
  EXPECT_EQ(of(c, 1).group, of(c, 2).group);
  EXPECT_NE(of(c, 1).group, of(c, 5).group);
  EXPECT_NEAR(of(c, 1).offset, 0.05, 1e-6);
  EXPECT_NEAR(of(c, 5).offset, -0.15, 1e-6);
  EXPECT_EQ(of(c, 9).pairs, 0);
  EXPECT_EQ(of(c, 9).offset, 0.0);
  EXPECT_TRUE(std::isnan(of(c, 9).sigma));
}

TEST(LineOffsets, SigmaIsTrueWhereTheTrajectoryDrifts) {
  constexpr double drift = 0.03;
  double square = 0.0;
  constexpr int seeds = 60;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    LineCells cells;
    overlap(cells, 1, 2, 0.1, drift, seed);
    const LineComparison c = compare_lines(cells, {});
    square += std::pow((of(c, 1).offset - 0.05) / of(c, 1).sigma, 2);
  }
  EXPECT_NEAR(std::sqrt(square / seeds), 1.0, 0.25);  // a median of 40 has 1.25 times the mean's error; chi square of 60
}

TEST(LineOffsets, AContradictionInALoopRaisesTheSigmas) {
  LineCells loop, chain;
  for (LineCells* c : {&loop, &chain}) {
    overlap(*c, 1, 2, 0.0);
    overlap(*c, 2, 3, 0.0);
  }
  overlap(loop, 1, 3, 0.2);
  EXPECT_GT(of(compare_lines(loop, {}), 2).sigma, 5.0 * of(compare_lines(chain, {}), 2).sigma);
}

TEST(LineOffsets, TheErrorOfALineIsADifferencesOverRootTwo) {
  // Many lines, each with an error of its own.
  std::mt19937 random(5);
  std::normal_distribution<double> error(0.0, 0.05);
  LineCells cells;
  std::vector<double> own;
  for (int line = 0; line < 200; ++line) own.push_back(error(random));
  for (int line = 1; line < 200; ++line) overlap(cells, line, line + 1, own[line - 1] - own[line]);
  const LineComparison c = compare_lines(cells, {});
  EXPECT_NEAR(c.common, 0.05, 0.005);
  EXPECT_NEAR(c.residual, 0.0, 0.002);
  EXPECT_NEAR(c.scatter, 0.02, 1e-6);
}

TEST(LineOffsets, ErrorsOfPlaceShowOnSlopes) {
  // Many lines, each off in height and, farther, to the east and north; level ground, and slopes to all sides.
  std::mt19937 random(5);
  std::normal_distribution<double> height(0.0, 0.03), place(0.0, 0.06);
  struct Line {
    double up, east, north;
  };
  std::vector<Line> lines;
  for (int line = 0; line < 300; ++line) lines.push_back({height(random), place(random), place(random)});
  LineCells level, both;
  for (int line = 1; line < 300; ++line) {
    const Line &a = lines[static_cast<size_t>(line) - 1], &b = lines[static_cast<size_t>(line)];
    const auto see = [&](LineCells& c, int i, double east, double north, int aspect) {
      const double d = a.up - b.up - east * (a.east - b.east) - north * (a.north - b.north);
      c.differences.push_back(
          {0, i, line, line, line + 1, 100, static_cast<float>(d), 0.0F, static_cast<float>(std::hypot(east, north)), aspect});
    };
    for (LineCells* c : {&level, &both}) see(*c, 0, 0.1, 0.0, 0);
    see(both, 0, -0.7, 0.0, 1), see(both, 1, 0.0, 0.5, 4), see(both, 2, 0.6, 0.0, 3), see(both, 3, 0.0, -0.4, 2);
  }
  const LineComparison c = compare_lines(both, {});
  EXPECT_NEAR(c.common, 0.03, 0.003);
  EXPECT_NEAR(c.common_horizontal, 0.06, 0.006);
  EXPECT_EQ(not_shown(c).size(), 1u);
  const LineComparison flat = compare_lines(level, {});
  EXPECT_TRUE(std::isnan(flat.common_horizontal));
  EXPECT_NE(not_shown(flat).back().find("steep ground"), std::string::npos);
  EXPECT_NE(not_shown(compare_lines({}, {})).back().find("No two lines"), std::string::npos);
  // Offsets are those of level ground.
  for (size_t k = 0; k < flat.lines.size(); ++k) EXPECT_EQ(flat.lines[k].offset, c.lines[k].offset);
}

TEST(LineOffsets, CellsAsNarrowAsTheDensityAllows) {
  LineCells cells;
  for (std::int32_t level = 0; level < 3; ++level)
    for (int k = 0; k < (level == 0 ? 5 : 20); ++k) cells.differences.push_back({level, k, 0, 1, 2, 256U >> (2 * level), 0.1F, 0.0F});
  cells.scatters = {{0, 0, 0, 1, 10, 0.02F}, {0, 0, 0, 2, 10, 0.02F}};
  EXPECT_EQ(compare_lines(cells, {}).cell, 4.0);
}

TEST(LineOffsets, OrderAndRepetitionChangeNothing) {
  LineCells cells;
  overlap(cells, 1, 2, 0.1, 0.03, 1);
  overlap(cells, 2, 3, -0.1, 0.03, 2);
  const LineComparison once = compare_lines(cells, {});
  LineCells twice = cells;
  twice.differences.insert(twice.differences.end(), cells.differences.begin(), cells.differences.end());
  twice.scatters.insert(twice.scatters.end(), cells.scatters.begin(), cells.scatters.end());
  std::shuffle(twice.differences.begin(), twice.differences.end(), std::mt19937(7));
  const LineComparison again = compare_lines(twice, {});
  for (size_t k = 0; k < once.lines.size(); ++k) {
    EXPECT_EQ(once.lines[k].offset, again.lines[k].offset);
    EXPECT_EQ(once.lines[k].sigma, again.lines[k].sigma);
  }
  EXPECT_EQ(once.common, again.common);
}

TEST(LineOffsets, NothingComparedIsNotAnError) {
  const LineComparison c = compare_lines({}, {});
  EXPECT_TRUE(c.lines.empty());
  EXPECT_TRUE(std::isnan(c.scatter));
  EXPECT_TRUE(std::isnan(c.common));
}

}  // namespace
}  // namespace swath::quality
