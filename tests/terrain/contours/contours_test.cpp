// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contours.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

core::Grid four(float sw, float se, float ne, float nw) {
  core::Grid g(core::Lattice{1.0, 10, 20, 2, 2});
  g.height = {sw, se, nw, ne};
  return g;
}
ContourOptions every_metre() { return {}; }

TEST(Contours, OneSquareHighGroundOnTheLeft) {
  const core::Grid g = four(0.5f, 0.5f, 1.5f, 1.5f);  // rising northward
  ContourOptions o = every_metre();
  o.base = core::Metres(0.05);  // the level below the middle
  const auto s = trace(g, g.lattice, o);
  ASSERT_EQ(s.size(), 2u + 1u);  // west, middle and east
  std::map<EdgeKey, const Segment*> by_start;
  for (const Segment& one : s) by_start[one.from] = &one;
  // Heading east keeps north on the left: from the western edge through the triangles at the foot of the northern half.
  const Segment* at = by_start.at(EdgeKey{10, 20, 1});
  EXPECT_EQ(at->level, 1);
  EXPECT_DOUBLE_EQ(at->from_x, 10.5);
  EXPECT_DOUBLE_EQ(at->from_y, 20.5 + 0.55);
  EdgeKey end = at->to;
  for (int n = 0; n < 2; ++n) end = by_start.at(end)->to;
  EXPECT_EQ(end, (EdgeKey{11, 20, 1}));
}

TEST(Contours, SaddleIsDecidedByTheMean) {
  for (const bool high : {true, false}) {
    const float low = high ? 0.8f : 0.2f, top = high ? 1.6f : 1.4f;
    const core::Grid g = four(top, low, top, low);
    const auto s = trace(g, g.lattice, every_metre());
    ASSERT_EQ(s.size(), 4u);
    // Joined high ground: the lines cut off the low corners (south-east: edges south and east), and the reverse.
    std::map<EdgeKey, EdgeKey> next;
    for (const Segment& one : s) next[one.from] = one.to;
    const std::vector<EdgeKey> border{{10, 20, 0}, {11, 20, 1}, {10, 21, 0}, {10, 20, 1}};
    for (const EdgeKey& start : border) {
      if (!next.contains(start)) continue;
      const EdgeKey end = next.at(next.at(start));
      const bool south = start == border[0] || end == border[0], east = start == border[1] || end == border[1];
      EXPECT_EQ(south == east, high);
    }
  }
}

TEST(Contours, CentresOnALevelCountAsAbove) {
  EXPECT_TRUE(trace(four(1, 1, 1, 1), {1.0, 10, 20, 1, 1}, every_metre()).empty());
  EXPECT_TRUE(trace(four(1, 1, 1.5f, 1.2f), {1.0, 10, 20, 1, 1}, every_metre()).empty());
  const auto s = trace(four(1, 0.5f, 0.5f, 0.5f), {1.0, 10, 20, 1, 1}, every_metre());
  ASSERT_EQ(s.size(), 2u);  // round the corner, a ten-thousandth of a cell from it
  for (const Segment& one : s) {
    EXPECT_NEAR(one.from_x, 10.5, 1.1e-4);
    EXPECT_NEAR(one.from_y, 20.5, 1.1e-4);
    EXPECT_TRUE(one.from_x != one.to_x || one.from_y != one.to_y);
  }
}

TEST(Contours, VoidCornersGiveNothing) {
  EXPECT_TRUE(trace(four(0, 3, std::nanf(""), 3), {1.0, 10, 20, 2, 2}, every_metre()).empty());
  EXPECT_FALSE(trace(four(0, 3, 3, 3), {1.0, 10, 20, 2, 2}, every_metre()).empty());
}

TEST(Contours, BaseAndNegativeLevels) {
  ContourOptions o;
  o.interval = core::Metres(0.5);
  o.base = core::Metres(0.1);
  const core::Grid g = four(-1.0f, -1.0f, 0.2f, 0.2f);
  const auto s = trace(g, g.lattice, o);
  std::set<std::int64_t> levels;
  for (const Segment& one : s) levels.insert(one.level);
  EXPECT_EQ(levels, (std::set<std::int64_t>{-2, -1, 0}));
  EXPECT_DOUBLE_EQ(level_height(o, s[0].level), -0.9);
  EXPECT_TRUE(is_index(o, -10));
  EXPECT_TRUE(is_index(o, 0));
  EXPECT_FALSE(is_index(o, 3));
  o.index = 0;
  EXPECT_FALSE(is_index(o, 0));
}

TEST(Contours, VerticesLieOnTheSurfaceWithinTheInterpolationBound) {
  // Along an edge of length 1 m linear interpolation errs by at most K/8; K = A / L^2. Along half a diagonal, 0.71 m, it errs by half as
  // much, and the middle itself, as the mean of four, by K/4 more (two edges across).
  const auto hills = [](double x, double y) { return 50.0 + 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0); };
  constexpr double bound = 6.0 / (9.0 * 9.0) / 4.0 + 4e-6 + 1e-4;  // and the rounding of heights to float
  const core::Grid g = test::sampled({1.0, 1000, 2000, 120, 90}, hills);
  double largest = 0.0;
  size_t n = 0;
  for (const Segment& s : trace(g, g.lattice, every_metre())) {
    largest = std::max({largest, std::abs(hills(s.from_x, s.from_y) - static_cast<double>(s.level)),
                        std::abs(hills(s.to_x, s.to_y) - static_cast<double>(s.level))});
    ++n;
    // Uphill on the left, tested where the segment is long enough to tell.
    const double dx = s.to_x - s.from_x, dy = s.to_y - s.from_y, mx = 0.5 * (s.from_x + s.to_x), my = 0.5 * (s.from_y + s.to_y);
    if (std::hypot(dx, dy) > 0.4) {
      ASSERT_GT(hills(mx - 0.3 * dy, my + 0.3 * dx), hills(mx + 0.3 * dy, my - 0.3 * dx));
    }
  }
  EXPECT_GT(n, 1000u);
  EXPECT_LE(largest, bound);
}

TEST(Contours, EveryEdgeIsLeftAndEnteredOnceAtMost) {
  // Whole-number noise: saddles and centres on levels everywhere.
  std::mt19937 random(7);
  std::uniform_int_distribution<int> height(0, 4);
  const core::Grid g = test::sampled({0.5, 0, 0, 60, 60}, [&](double, double) { return 0.5 * height(random); });
  std::map<std::pair<std::int64_t, EdgeKey>, int> left, entered;
  for (const Segment& s : trace(g, g.lattice, every_metre())) {
    EXPECT_EQ(++left[std::make_pair(s.level, s.from)], 1);
    EXPECT_EQ(++entered[std::make_pair(s.level, s.to)], 1);
  }
  EXPECT_GT(left.size(), 1000u);
}

TEST(Contours, TilesTogetherGiveTheSegmentsOfTheWhole) {
  const auto hills = [](double x, double y) { return 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0); };
  const core::Grid whole = test::sampled({1.0, 100, 200, 70, 50}, hills);
  const std::vector<Segment> expected = trace(whole, whole.lattice, every_metre());
  for (const int cells : {7, 32}) {
    std::vector<Segment> all;
    for (int tj = 0; tj < 50; tj += cells)
      for (int ti = 0; ti < 70; ti += cells) {
        const core::Lattice own{1.0, 100 + ti, 200 + tj, std::min(cells, 70 - ti), std::min(cells, 50 - tj)};
        core::Lattice with_border = own;
        with_border.nx = std::min(own.nx + 1, 70 - ti);
        with_border.ny = std::min(own.ny + 1, 50 - tj);
        const auto part = trace(test::sampled(with_border, hills), own, every_metre());
        all.insert(all.end(), part.begin(), part.end());
      }
    std::sort(all.begin(), all.end());
    EXPECT_TRUE(test::same_bits(all, expected)) << cells;
  }
}

}  // namespace
}  // namespace swath::terrain
