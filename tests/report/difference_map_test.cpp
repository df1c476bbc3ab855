// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/difference_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::report {
namespace {

/// West half `west`, east half `east`, the southernmost row without a value.
core::Grid halves(float west, float east, int nx = 60, int ny = 40) {
  core::Grid g(core::Lattice{2.0, 500, 700, nx, ny});
  for (int j = 1; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      g.height[g.lattice.at(i, j)] = i < nx / 2 ? west : east;
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  return g;
}

core::Picture difference_picture(const core::Grid& g, const DifferenceMapOptions& o = {}) { return draw(difference_map(g, o)); }

bool is(const std::uint8_t* c, core::Rgb colour) { return std::equal(colour.begin(), colour.end(), c); }

TEST(DifferenceMap, PaletteIsWhiteAtZeroBlueBelowRedAbove) {
  const core::Rgb zero = diverging_colour(0.0), low = diverging_colour(-1.0), high = diverging_colour(1.0);
  EXPECT_GT(*std::min_element(zero.begin(), zero.end()), 245);
  EXPECT_GT(low[2], low[0] + 100);
  EXPECT_GT(high[0], high[2] + 100);
  EXPECT_EQ(diverging_colour(-7.0), low);
  EXPECT_EQ(diverging_colour(7.0), high);
  // Farther from zero is never lighter.
  for (const double sign : {-1.0, 1.0}) {
    int before = 3 * 255;
    for (int k = 0; k <= 20; ++k) {
      const core::Rgb c = diverging_colour(sign * k / 20.0);
      EXPECT_LE(c[0] + c[1] + c[2], before);
      before = c[0] + c[1] + c[2];
    }
  }
}

TEST(DifferenceMap, RangeIsARoundNumberAboveNearlyAllDifferences) {
  EXPECT_DOUBLE_EQ(difference_range(halves(-0.031f, 0.012f)), 0.05);
  EXPECT_DOUBLE_EQ(difference_range(halves(-0.05f, 0.0f)), 0.05);
  EXPECT_DOUBLE_EQ(difference_range(halves(-1.1f, 0.9f)), 2.0);
  EXPECT_DOUBLE_EQ(difference_range(halves(0.0f, 0.0f)), 0.001);
  EXPECT_DOUBLE_EQ(difference_range(core::Grid(core::Lattice{1.0, 0, 0, 4, 4})), 0.001);
  core::Grid one_far = halves(0.01f, -0.01f);
  one_far.height[one_far.lattice.at(3, 3)] = 9.0f;
  EXPECT_DOUBLE_EQ(difference_range(one_far), 0.01);
}

TEST(DifferenceMap, CellsHaveTheColourOfTheirDifference) {
  DifferenceMapOptions o;
  o.range = 0.1;
  const core::Picture p = difference_picture(halves(-0.1f, 0.05f), o);
  // 60 x 40 cells of 16 pixels; without a title the map starts at the margin of 14.
  ASSERT_GE(p.width, 960);
  const int left = (p.width - 960) / 2;
  EXPECT_TRUE(is(p.at(left + 100, 14 + 100), diverging_colour(-1.0)));
  EXPECT_TRUE(is(p.at(left + 900, 14 + 100), diverging_colour(0.5)));
  const std::uint8_t* nothing = p.at(left + 500, 14 + 39 * 16 + 8);
  EXPECT_EQ(nothing[0], nothing[2]) << "no difference is grey";
}

TEST(DifferenceMap, TheLegendTellsOfVoidsAndOfWhatIsBeyond) {
  core::Grid g = halves(0.01f, -0.01f);
  DifferenceMapOptions o;
  o.range = 0.02;
  const core::Picture all_within = difference_picture(g, o);
  for (int i = 0; i < 60; ++i) g.height[g.lattice.at(i, 5)] = 1.0f;
  EXPECT_NE(difference_picture(g, o).rgb, all_within.rgb);
  o.title = "Line 1 minus line 2";
  EXPECT_GT(difference_picture(g, o).height, all_within.height);
}

TEST(DifferenceMap, LargeGridsAreAveragedAndEmptyOnesGiveNothing) {
  DifferenceMapOptions o;
  o.max_side = 300;
  const core::Picture p = difference_picture(halves(-0.1f, 0.1f, 1200, 400), o);
  EXPECT_EQ(p.width, 760);  // room for the legend; the map itself is 300 x 100
  EXPECT_LT(p.height, 220);
  EXPECT_EQ(p.rgb, difference_picture(halves(-0.1f, 0.1f, 1200, 400), o).rgb);
  EXPECT_EQ(difference_picture(core::Grid()).width, 0);
  EXPECT_GT(difference_picture(core::Grid(core::Lattice{1.0, 0, 0, 4, 4})).width, 0) << "a map without any difference";
}

}  // namespace
}  // namespace swath::report
