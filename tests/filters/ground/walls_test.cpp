// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace swath::filters {
namespace {

constexpr int size = 300;
constexpr float level = 100.0F;

Raster heights(const std::function<float(int i, int j)>& at, int every = 1) {
  Raster r(size, size, std::nanf(""));
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      if ((i * 7 + j * 3) % every == 0) r.value[r.at(i, j)] = at(i, j);
  return r;
}

bool within(int i, int j, int i0, int j0, int i1, int j1) { return i >= i0 && i < i1 && j >= j0 && j < j1; }

/// Cells of `before` voided in the box, as a share of those there.
double voided(const Raster& before, const Raster& after, int i0, int j0, int i1, int j1) {
  int all = 0, gone = 0;
  for (int j = j0; j < j1; ++j)
    for (int i = i0; i < i1; ++i) {
      all += !std::isnan(before.value[before.at(i, j)]);
      gone += !std::isnan(before.value[before.at(i, j)]) && std::isnan(after.value[after.at(i, j)]);
    }
  return static_cast<double>(gone) / all;
}

TEST(Walls, AHallOf150By90MetresIsNotGround) {
  for (const int every : {1, 2}) {
    const Raster before = heights([](int i, int j) { return within(i, j, 60, 100, 210, 190) ? level + 9.0F : level; }, every);
    Raster after = before;
    remove_walled(after, {});
    EXPECT_GT(voided(before, after, 60, 100, 210, 190), 0.99) << every;
    EXPECT_EQ(voided(before, after, 0, 0, size, 95), 0.0) << every;
    Raster kept = before;
    remove_walled(kept, {.longest = 0});
    EXPECT_EQ(voided(before, kept, 0, 0, size, size), 0.0);
  }
}

TEST(Walls, AStraightRimThroughAHallOf150By90MetresDoesNotKeepIt) {
  struct Part {
    int i0, j0, width, height;
  };
  // Cut along its length and along its width: a quarter, a half and three quarters of it are in the data.
  for (const Part& p : {Part{60, 0, 150, 22}, Part{60, 0, 150, 45}, Part{60, 0, 150, 68}, Part{0, 100, 38, 90}, Part{0, 100, 75, 90},
                        Part{0, 100, 112, 90}}) {
    const Raster before =
        heights([&](int i, int j) { return within(i, j, p.i0, p.j0, p.i0 + p.width, p.j0 + p.height) ? level + 9.0F : level; });
    Raster after = before;
    remove_walled(after, {});
    EXPECT_EQ(voided(before, after, p.i0, p.j0, p.i0 + p.width, p.j0 + p.height), 1.0) << p.width << " x " << p.height;
    EXPECT_EQ(voided(before, after, 220, 0, size, size), 0.0);
  }
}

TEST(Walls, ATerraceThatTheRimCutsStays) {
  // Two of its sides are the rim of the data.
  const Raster before = heights([](int i, int j) { return i + j < 150 ? level + 5.0F : level; });
  Raster after = before;
  EXPECT_TRUE(remove_walled(after, {.farthest = 250}).empty());
  EXPECT_EQ(voided(before, after, 0, 0, size, size), 0.0);
}

TEST(Walls, TerracesOfASlopeStay) {
  // Steps of 3 m every 12 m, 40 m long, set off from those beside by half a step. Of those at the rim too little is seen.
  const Raster before = heights([](int i, int j) {
    const int odd = i / 40 % 2;
    const double step = 3.0 * std::floor((j + 6 * odd) / 12.0) - 1.5 * odd;
    return level + static_cast<float>(j < 60 || j > 240 ? 0.25 * j : step);
  });
  Raster after = before;
  EXPECT_TRUE(remove_walled(after, {.farthest = 250}).empty());
  EXPECT_EQ(voided(before, after, 40, 0, 280, size), 0.0);
}

TEST(Walls, WhatIsTooLongStaysAndIsReportedWithPlaceAndSize) {
  const Raster before = heights([](int i, int j) { return within(i, j, 40, 100, 260, 220) ? level + 9.0F : level; });
  Raster after = before;
  EXPECT_TRUE(remove_walled(after, {}).empty());  // it is not asked for
  const std::vector<WalledHill> hills = remove_walled(after, {.farthest = 250});
  EXPECT_EQ(voided(before, after, 0, 0, size, size), 0.0);
  ASSERT_EQ(hills.size(), 1u);
  EXPECT_NEAR(hills[0].east, 150.0, 0.1);
  EXPECT_NEAR(hills[0].north, 160.0, 0.1);
  EXPECT_NEAR(hills[0].length, 220.0, 0.5);
  EXPECT_NEAR(hills[0].width, 120.0, 0.5);
  EXPECT_NEAR(hills[0].rise, 9.0, 1e-6);
  EXPECT_EQ(hills[0].height, level + 9.0F);
  EXPECT_NEAR(hills[0].i + 0.5, hills[0].east, 1.0);
  EXPECT_TRUE(remove_walled(after, {.farthest = 200}).empty());
  EXPECT_TRUE(remove_walled(after, {.longest = 230, .farthest = 250}).empty());
  EXPECT_EQ(voided(before, after, 40, 100, 260, 220), 1.0);
}

TEST(Walls, GableRoofsAndHedgesAtTheirEavesChangeNothing) {
  const Raster before = heights([](int i, int j) {
    if (within(i, j, 60, 60, 120, 84)) return level + 4.0F + 0.5F * static_cast<float>(12 - std::abs(j - 72));
    if (j >= 84 && j < 87 && i == 90) return level + 1.2F * static_cast<float>(87 - j);  // a way down, one cell wide
    return level;
  });
  Raster after = before;
  remove_walled(after, {});
  EXPECT_EQ(voided(before, after, 61, 61, 119, 83), 1.0);
  EXPECT_EQ(voided(before, after, 130, 0, size, size), 0.0);
}

TEST(Walls, ARoofThatTheRimCutsIsNotGround) {
  const Raster before =
      heights([](int i, int j) { return within(i, j, 100, 0, 130, 12) || within(i, j, 0, 290, 20, 300) ? level + 6.0F : level; });
  Raster after = before;
  remove_walled(after, {});
  EXPECT_EQ(voided(before, after, 100, 0, 130, 12), 1.0);
  EXPECT_EQ(voided(before, after, 0, 290, 20, 300), 1.0);
  EXPECT_EQ(voided(before, after, 0, 20, size, 280), 0.0);
}

TEST(Walls, ALowRoofAtTheRimBesideAHigherOneIsNotGround) {
  // Dormers and light wells break one side up: their cells lie on no surface, and say nothing about where the roof ends.
  const Raster before = heights([](int i, int j) {
    if (within(i, j, 108, 0, 130, 24)) return level + 9.0F;
    if (within(i, j, 96, 16, 108, 20)) return level + ((i + j) % 2 == 0 ? 2.5F : 4.9F);
    return within(i, j, 96, 0, 108, 16) ? level + 4.0F : level;
  });
  Raster after = before;
  remove_walled(after, {});
  EXPECT_EQ(voided(before, after, 97, 0, 107, 14), 1.0);
  EXPECT_EQ(voided(before, after, 0, 26, size, size), 0.0);
}

TEST(Walls, GroundBesideAWallStays) {
  // A terrace above a retaining wall, an embankment, a hill, a courtyard and a slope of 40 degrees.
  const std::function<float(int, int)> grounds[] = {
      [](int i, int) { return i < 120 ? level + 5.0F : level; },
      [](int i, int) { return level + std::max(0.0F, 6.0F - 0.7F * static_cast<float>(std::abs(i - 150))); },
      [](int i, int j) { return level + std::max(0.0F, 20.0F - 0.8F * static_cast<float>(std::hypot(i - 150, j - 150))); },
      [](int i, int j) { return within(i, j, 100, 100, 180, 180) && !within(i, j, 120, 120, 160, 160) ? level + 8.0F : level; },
      [](int i, int) { return level + 0.84F * static_cast<float>(i); }};
  for (size_t k = 0; k < std::size(grounds); ++k) {
    const Raster before = heights(grounds[k]);
    Raster after = before;
    remove_walled(after, {});
    const auto is_roof = [&](int i, int j) { return k == 3 && before.value[before.at(i, j)] > level + 1.0F; };
    int lost = 0;
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) lost += std::isnan(after.value[after.at(i, j)]) && !is_roof(i, j);
    EXPECT_EQ(lost, 0) << k;
  }
}

TEST(Walls, AParcelBetweenDeepDitchesStays) {
  const Raster before = heights([](int i, int j) {
    const bool ring = within(i, j, 98, 98, 162, 162) && !within(i, j, 100, 100, 160, 160);
    return ring ? level - 3.0F : level;
  });
  Raster after = before;
  remove_walled(after, {});
  EXPECT_EQ(voided(before, after, 100, 100, 160, 160), 0.0);
}

TEST(Walls, NothingBeyondTheSupportMatters) {
  const WallOptions o{.longest = 40, .widest = 20};
  const Raster before = heights(
      [](int i, int j) { return (i / 15 + j / 22) % 3 == 0 ? level + 5.0F + 0.01F * static_cast<float>((i * 31 + j * 17) % 9) : level; });
  Raster part(size, size, std::nanf("")), all = before;
  const int reach = wall_support(o);
  for (int j = 150 - reach; j <= 150 + reach; ++j)
    for (int i = 150 - reach; i <= 150 + reach; ++i) part.value[part.at(i, j)] = before.value[before.at(i, j)];
  remove_walled(all, o);
  remove_walled(part, o);
  for (int j = 148; j <= 152; ++j)
    for (int i = 148; i <= 152; ++i) EXPECT_EQ(std::isnan(all.value[all.at(i, j)]), std::isnan(part.value[part.at(i, j)])) << i << " " << j;
}

}  // namespace
}  // namespace swath::filters
