// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/spot_heights.h"

#include <gtest/gtest.h>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

const test::Surface hills = [](double x, double y) { return 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0); };

SpotOptions within(double radius, double relief = 0.5) {
  SpotOptions o;
  o.radius = core::Metres(radius);
  o.relief = core::Metres(relief);
  return o;
}

TEST(SpotHeights, TopsAndPitsOfAnalyticHills) {
  const core::Grid g = test::sampled({1.0, 0, 0, 140, 110}, hills);
  size_t tops = 0, pits = 0;
  for (const SpotHeight& s : spot_heights(g, g.lattice, within(15.0))) {
    ++(s.top ? tops : pits);
    // Half a cell beside the true extreme the surface is (0.5 m)^2 (1/11^2 + 1/9^2) 6 m / 2 lower.
    EXPECT_NEAR(s.height, s.top ? 6.0 : -6.0, 0.02);
    const double sx = std::sin((static_cast<double>(s.i) + 0.5) / 11.0), cy = std::cos((static_cast<double>(s.j) + 0.5) / 9.0);
    EXPECT_GT(sx * cy * (s.top ? 1.0 : -1.0), 0.99);
  }
  // sin(x / 11) is +-1 at x = 17.3, 51.8, 86.4, 121; cos(y / 9) at y = 0 (the edge), 28.3, 56.5, 84.8.
  EXPECT_EQ(tops, 6u);
  EXPECT_EQ(pits, 6u);
}

TEST(SpotHeights, SlopesEdgesVoidsAndNoiseMakeNone) {
  const core::Grid slope = test::sampled({1.0, 0, 0, 60, 60}, [](double x, double y) { return 0.1 * x + 0.05 * y; });
  EXPECT_TRUE(spot_heights(slope, slope.lattice, within(10.0, 0.0)).empty());
  core::Grid holed = slope;
  holed.height[holed.lattice.at(30, 30)] = std::nanf("");
  EXPECT_TRUE(spot_heights(holed, holed.lattice, within(10.0, 0.0)).empty());
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.03);
  const core::Grid flat = test::sampled({1.0, 0, 0, 90, 90}, [&](double, double) { return noise(random); });
  EXPECT_TRUE(spot_heights(flat, flat.lattice, within(10.0)).empty());
  EXPECT_FALSE(spot_heights(flat, flat.lattice, within(10.0, 0.0)).empty());
  EXPECT_TRUE(spot_heights(flat, flat.lattice, within(0.0, 0.0)).empty());
}

TEST(SpotHeights, OfAPlateauOneCellStands) {
  core::Grid g = test::sampled({1.0, 0, 0, 40, 40}, [](double x, double y) { return -0.1 * std::hypot(x - 20.0, y - 20.0); });
  for (int j = 18; j <= 22; ++j)
    for (int i = 18; i <= 22; ++i) g.height[g.lattice.at(i, j)] = 1.0f;
  const auto spots = spot_heights(g, g.lattice, within(10.0));
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_EQ(spots[0].i, 18);
  EXPECT_EQ(spots[0].j, 18);
}

TEST(SpotHeights, TilesGiveTheSame) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> step(0, 3);
  const core::Grid g = test::sampled({1.0, 100, -50, 90, 80}, [&](double x, double y) { return hills(x, y) + 0.25 * step(random); });
  const SpotOptions o = within(9.0);
  const auto all = spot_heights(g, g.lattice, o);
  EXPECT_GT(all.size(), 5u);
  for (const int side : {13, 40}) {
    std::vector<SpotHeight> parts;
    for (int tj = 0; tj < 80; tj += side)
      for (int ti = 0; ti < 90; ti += side) {
        const core::Lattice own{1.0, 100 + ti, -50 + tj, std::min(side, 90 - ti), std::min(side, 80 - tj)};
        constexpr int border = 9;
        core::Grid window(core::Lattice{1.0, own.i0 - border, own.j0 - border, own.nx + 2 * border, own.ny + 2 * border});
        for (int j = 0; j < window.lattice.ny; ++j)
          for (int i = 0; i < window.lattice.nx; ++i) {
            const int gi = ti - border + i, gj = tj - border + j;
            if (g.lattice.holds(gi, gj)) window.height[window.lattice.at(i, j)] = g.height[g.lattice.at(gi, gj)];
          }
        const auto part = spot_heights(window, own, o);
        parts.insert(parts.end(), part.begin(), part.end());
      }
    std::sort(parts.begin(), parts.end());
    EXPECT_EQ(parts, all) << side;
  }
}

}  // namespace
}  // namespace swath::terrain
