// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/world/support.h"

namespace swath::report {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

/// Level ground at 100 m, the northern half at 120 m.
core::Grid two_levels(int nx, int ny) {
  core::Grid g(core::Lattice{2.0, 1000, 2000, nx, ny});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      g.height[g.lattice.at(i, j)] = j >= ny / 2 ? 120.0f : 100.0f;
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  return g;
}

core::Picture relief_picture(const core::Grid& g, const std::vector<core::ContourLine>& lines = {}, const PictureOptions& o = {}) {
  return draw(relief_map(g, lines, o));
}

int brightness(const core::Picture& p, int x, int y) { return p.at(x, y)[0] + p.at(x, y)[1] + p.at(x, y)[2]; }

int differing(const core::Picture& a, const core::Picture& b) {
  int n = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) n += !std::equal(a.at(x, y), a.at(x, y) + 3, b.at(x, y));
  return n;
}

TEST(Picture, NorthIsUpAndHighGroundHasItsOwnColour) {
  const core::Picture p = relief_picture(two_levels(100, 80));
  // 100 x 80 cells are enlarged tenfold; without a title the map starts at the margin of 14.
  ASSERT_GE(p.width, 1028);
  const std::uint8_t* north = p.at(500, 100);
  const std::uint8_t* south = p.at(500, 700);
  EXPECT_GT(south[1], south[0] + 20);            // green low ground
  EXPECT_LT(std::abs(north[0] - north[2]), 20);  // stone
}

TEST(Picture, TheMapKeepsItsLongestSideAndTheSameBytes) {
  const core::Grid g = two_levels(900, 300);
  PictureOptions o;
  o.max_side = 400;
  const core::Picture p = relief_picture(g, {}, o);
  EXPECT_EQ(p.width, 760);  // room for the legend; the map itself is 300 x 100
  EXPECT_LT(p.height, 250);
  EXPECT_EQ(p.rgb, relief_picture(g, {}, o).rgb);
  EXPECT_EQ(relief_picture(core::Grid()).width, 0);
}

TEST(Picture, BlocksAreAveragedAndMostlyEmptyOnesAreVoid) {
  core::Grid g = two_levels(5, 4);  // blocks of 2: three columns, the last one cell wide
  g.height[g.lattice.at(0, 0)] = 104.0f;
  for (const auto& [i, j] : {std::pair(2, 0), {3, 0}, {2, 1}}) {
    g.height[g.lattice.at(i, j)] = none;
    g.reason[g.lattice.at(i, j)] = core::Void::water;
  }
  g.height[g.lattice.at(4, 0)] = none;
  g.reason[g.lattice.at(4, 0)] = core::Void::long_edge;
  const core::Grid a = averaged(g, 2);
  EXPECT_EQ(a.lattice.nx, 3);
  EXPECT_EQ(a.lattice.ny, 2);
  EXPECT_EQ(a.lattice.cell, 4.0);
  EXPECT_EQ(a.height[0], 101.0f);
  EXPECT_TRUE(std::isnan(a.height[1]));
  EXPECT_EQ(a.reason[1], core::Void::water);
  EXPECT_EQ(a.height[2], 100.0f);  // one of two cells has a height: half is enough
  EXPECT_EQ(a.height[3], 120.0f);
  EXPECT_EQ(averaged(g, 1).reason[4], core::Void::long_edge);
}

TEST(Picture, AVoidKeepsItsReasonWhenItIsAveraged) {
  for (const core::Void reason : {core::Void::no_data, core::Void::long_edge, core::Void::water, core::Void::never_seen}) {
    core::Grid g(core::Lattice{1.0, 0, 0, 4, 4});
    std::fill(g.reason.begin(), g.reason.end(), reason);
    for (const core::Void shown : averaged(g, 2).reason) EXPECT_EQ(shown, reason);
  }
}

TEST(Picture, GroundNeverSeenIsNotDrawnAsWater) {
  core::Grid g = two_levels(400, 400);
  for (int j = 100; j < 300; ++j)
    for (int i = 100; i < 300; ++i) {
      g.height[g.lattice.at(i, j)] = none;
      g.reason[g.lattice.at(i, j)] = core::Void::never_seen;
    }
  PictureOptions o;
  o.max_side = 100;  // four cells to a pixel
  const core::Picture p = relief_picture(g, {}, o);
  const int x = p.width / 2;
  for (int dx = -10; dx < 10; ++dx) EXPECT_LE(p.at(x + dx, 14 + 50)[2], p.at(x + dx, 14 + 50)[0] + 10) << dx;  // blue is water's
}

TEST(Picture, ContoursLieWhereTheyAre) {
  core::Grid g = two_levels(100, 80);
  std::fill(g.height.begin(), g.height.end(), 100.0f);
  core::ContourLine line;
  line.x = {g.lattice.west(), g.lattice.east()};
  line.y = {g.lattice.south() + 40.0, g.lattice.south() + 40.0};  // 20 cells from the south = 200 pixels from below
  PictureOptions o;
  o.labels = false;
  const core::Picture bare = relief_picture(g, {}, o);
  const int row = 14 + 800 - 200;
  line.index = true;
  const core::Picture index = relief_picture(g, {line}, o);
  line.index = false;
  const core::Picture ordinary = relief_picture(g, {line}, o);
  for (const int x : {20, 500, 1000}) {
    for (const int y : {row - 1, row}) {
      EXPECT_LT(brightness(index, x, y), brightness(ordinary, x, y));
      EXPECT_LT(brightness(ordinary, x, y), brightness(bare, x, y));
    }
    for (const int y : {row - 3, row + 2}) EXPECT_EQ(brightness(index, x, y), brightness(bare, x, y));
  }
}

TEST(Picture, IndexContoursBearTheirHeights) {
  core::Grid g = two_levels(100, 80);
  core::ContourLine line;
  line.x = {g.lattice.west() + 10, g.lattice.east() - 10};
  line.y = {g.lattice.south() + 40.0, g.lattice.south() + 60.0};
  line.height = 105.0;
  line.index = true;
  PictureOptions o;
  const core::Picture labelled = relief_picture(g, {line}, o);
  o.labels = false;
  EXPECT_GT(differing(labelled, relief_picture(g, {line}, o)), 100);
}

TEST(Picture, ATangleOfContoursIsThinnedToIndexContours) {
  const core::Grid g = two_levels(100, 80);
  std::vector<core::ContourLine> lines;
  for (int k = 0; k < 400; ++k) {
    core::ContourLine line;
    line.x = {g.lattice.west(), g.lattice.east()};
    line.y = {g.lattice.south() + 0.4 * k, g.lattice.south() + 0.4 * k};
    line.height = k;
    line.index = k == 200;
    lines.push_back(line);
  }
  PictureOptions o;
  o.labels = false;
  const core::Picture all = relief_picture(g, lines, o), one = relief_picture(g, {lines[200]}, o);
  int rows = 0;
  for (int y = 20; y < 800; ++y) rows += brightness(all, 500, y) != brightness(one, 500, y);
  EXPECT_EQ(rows, 0);
}

TEST(Picture, ContoursOnASteepSlopeKeepApart) {
  // A slope of 2 from 100 m to 500 m, then flat, a pixel per metre: contours of 5 m would lie 2.5 pixels apart, those of 10 m 5.
  core::Grid g({1.0, 0, 0, 400, 60});
  const auto height = [](double x) { return 100.0 + 2.0 * std::min(x, 200.0); };
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 400; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(height(i + 0.5));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  PictureOptions o;
  o.labels = false;
  o.max_side = 400;
  std::vector<core::ContourLine> lines;
  for (int z = 101; z < 500; ++z) {
    core::ContourLine line;
    line.height = z, line.index = z % 5 == 0;
    const double x = (z - 100.0) / 2.0;
    line.x = {x, x}, line.y = {0.0, 60.0};
    lines.push_back(line);
  }
  const core::Picture all = relief_picture(g, lines, o), bare = relief_picture(g, {}, o);
  std::erase_if(lines, [](const core::ContourLine& line) { return static_cast<int>(line.height) % 10 != 0; });
  const core::Picture tenths = relief_picture(g, lines, o);
  int drawn = 0;
  for (int x = 0; x < all.width; ++x) {
    EXPECT_EQ(brightness(all, x, 44), brightness(tenths, x, 44)) << x;
    drawn += brightness(all, x, 44) != brightness(bare, x, 44);
  }
  EXPECT_GE(drawn, 38);  // 39 lines of 10 m, 2 pixels each
  EXPECT_LE(drawn, 120);
}

TEST(Picture, EachKindOfVoidLooksDifferent) {
  core::Grid g = two_levels(100, 80);
  const auto hole = [&](int from, core::Void reason) {
    for (int j = 10; j < 30; ++j)
      for (int i = from; i < from + 20; ++i) {
        g.height[g.lattice.at(i, j)] = none;
        g.reason[g.lattice.at(i, j)] = reason;
      }
  };
  hole(10, core::Void::no_data);
  hole(40, core::Void::water);
  hole(70, core::Void::long_edge);
  const core::Picture p = relief_picture(g);
  const int y = 14 + 600;
  const auto mean = [&](int x0, int channel) {
    int sum = 0;
    for (int x = x0; x < x0 + 100; ++x) sum += p.at(x, y)[channel];
    return sum / 100;
  };
  EXPECT_NEAR(mean(160, 0), mean(160, 2), 2);  // grey hatching
  EXPECT_GT(mean(460, 2), mean(460, 0) + 40);  // blue
  EXPECT_GT(mean(760, 0), mean(760, 2) + 5);   // reddish hatching
}

TEST(Picture, VoidEverywhereAndOneCellAreDrawn) {
  EXPECT_GT(relief_picture(core::Grid(core::Lattice{1.0, 0, 0, 30, 20})).width, 0);
  core::Grid one(core::Lattice{1.0, 0, 0, 1, 1});
  one.height[0] = 5.0f;
  one.reason[0] = core::Void::none;
  EXPECT_GT(relief_picture(one).height, 0);
}

TEST(Picture, ALongTitleWidensThePicture) {
  PictureOptions o;
  o.title = std::string(80, 'W');
  EXPECT_GT(relief_picture(two_levels(20, 400), {}, o).width, 80 * 18);
}

}  // namespace
}  // namespace swath::report
