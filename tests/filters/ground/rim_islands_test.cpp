// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/rim_islands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace swath::filters {
namespace {

constexpr int beyond = 20, side = 80;  // cells: without returns around, and with
const float nothing = std::nanf("");

using Heights = std::function<double(int, int)>;

/// Ground in a square with a rim around it; NaN in `heights` where something else was taken off.
struct Scene {
  Raster ground{side + 2 * beyond, side + 2 * beyond, nothing}, rim;

  explicit Scene(const Heights& heights, double share = 1.0) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    Raster lowest = ground;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const double z = heights(i, j) + 0.04 * part(random);
        if (part(random) > share) continue;
        lowest.value[at(i, j)] = std::isnan(z) ? 9.0F : static_cast<float>(z);
        ground.value[at(i, j)] = static_cast<float>(z);
      }
    rim = rim_cells(lowest);
  }
  size_t at(int i, int j) const { return ground.at(i + beyond, j + beyond); }
  int held(int i0, int i1, int j0, int j1) const {
    int n = 0;
    for (int j = j0; j < j1; ++j)
      for (int i = i0; i < i1; ++i) n += !std::isnan(ground.value[at(i, j)]);
    return n;
  }
};

TEST(RimIslands, TheRimIsTheOutermostCells) {
  Raster lowest(60, 60, 1.0F);
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 60; ++i)
      if (i < 20 || (j >= 30 && j < 40)) lowest.value[lowest.at(i, j)] = nothing;
  const Raster rim = rim_cells(lowest);
  EXPECT_TRUE(std::isnan(rim.value[rim.at(19, 10)]));
  EXPECT_EQ(rim.value[rim.at(20, 10)], 1.0F);
  EXPECT_EQ(rim.value[rim.at(21, 10)], 1.0F);
  EXPECT_EQ(rim.value[rim.at(22, 10)], 0.0F);
  EXPECT_EQ(rim.value[rim.at(50, 29)], 0.0F);  // a void of 10 cells is no outside
  EXPECT_EQ(rim.value[rim.at(59, 10)], 0.0F);  // what is beyond the raster is not known
}

TEST(RimIslands, PartsOfRoofsAtTheRimAreOff) {
  for (const double share : {1.0, 0.5}) {
    const auto slope = [](int i, int j) { return 0.1 * i + 0.05 * j; };
    // A garage that nothing hides, an annexe before a house that was taken off, one too large.
    Scene s(
        [&](int i, int j) {
          if (i < 6 && j >= 10 && j < 18) return slope(i, j) + 2.6;
          if (i < 4 && j >= 30 && j < 45) return slope(i, j) + 2.6;
          if (i < 16 && j >= 29 && j < 46) return static_cast<double>(nothing);
          return slope(i, j) + (j >= 76 && i < 40 ? 2.6 : 0.0);
        },
        share);
    const Scene before = s;
    remove_rim_islands(s.ground, s.rim);
    EXPECT_GT(before.held(0, 6, 10, 18), 0);
    EXPECT_EQ(s.held(0, 6, 10, 18), 0);
    EXPECT_EQ(s.held(0, 4, 30, 45), 0);
    EXPECT_EQ(s.held(0, 40, 76, side), before.held(0, 40, 76, side));
    EXPECT_EQ(s.held(0, side, 0, side), before.held(0, side, 0, side) - before.held(0, 6, 10, 18) - before.held(0, 4, 30, 45));
  }
}

void expect_kept(const Heights& heights, const char* what) {
  for (const double share : {1.0, 0.3}) {
    Scene s(heights, share);
    const int before = s.held(0, side, 0, side);
    remove_rim_islands(s.ground, s.rim);
    EXPECT_EQ(s.held(0, side, 0, side), before) << what << ", " << share;
  }
}

TEST(RimIslands, GroundAtTheRimStays) {
  const auto bank = [](double x) { return std::clamp(x, 0.0, 6.0); };
  expect_kept([&](int i, int) { return bank(10.0 - i); }, "a bank along the rim");
  expect_kept([&](int i, int j) { return bank(0.8 * (12.0 - std::hypot(i, j - 40))); }, "the end of a dike");
  expect_kept([](int i, int j) { return 25.0 * std::exp(-(i * i + (j - 40.0) * (j - 40.0)) / 400.0); }, "a hill");
  expect_kept([](int i, int j) { return 0.6 * i + 3.0 * std::sin(0.3 * j); }, "spurs");
  expect_kept([](int i, int j) { return i < 8 && j >= 20 && j < 40 ? 1.2 : 0.0; }, "a loading bay");
  // Terraces of 3 m, cut by the rim: the country is no plane.
  expect_kept([](int i, int j) { return 3.0 * (i / 12) + 3.0 * (j / 15); }, "terraces");
  // The crest of a bank whose flank bushes hide is as high as the bank beyond them.
  expect_kept([&](int i, int j) { return j >= 20 && j < 30 && i >= 4 && i < 12 ? static_cast<double>(nothing) : bank(10.0 - i); },
              "bushes");
}

TEST(RimIslands, WithoutARimNothingIsOff) {
  Scene s([](int i, int j) { return i >= 30 && i < 40 && j >= 30 && j < 40 ? 2.6 : 0.0; });
  const int before = s.held(0, side, 0, side);
  remove_rim_islands(s.ground, s.rim);
  EXPECT_EQ(s.held(0, side, 0, side), before);
}

}  // namespace
}  // namespace swath::filters
