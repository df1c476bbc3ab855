// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/void_areas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace swath::quality {
namespace {

constexpr PulseSpacing half_metre{0.5, 0.5};  // cells of 0.125 m, footprint cells of 8 m

/// Footprint cells over a box of map metres.
std::vector<FootprintCell> covered(double x0, double y0, double x1, double y1) {
  std::vector<FootprintCell> out;
  for (double x = x0; x < x1; x += 8)
    for (double y = y0; y < y1; y += 8) out.push_back({static_cast<int>(std::floor(x / 8)), static_cast<int>(std::floor(y / 8))});
  return out;
}

/// Rows of void over a box, with `rim` returns beside the first of them.
std::vector<VoidRun> box(double x0, double y0, double x1, double y1, std::uint32_t rim = 0, std::uint32_t rim_water = 0) {
  std::vector<VoidRun> out;
  const auto cell = [](double v) { return static_cast<std::int32_t>(std::lround(v / 0.125)); };
  for (std::int32_t j = cell(y0); j < cell(y1); ++j) out.push_back({j, cell(x0), cell(x1), rim, rim_water});
  return out;
}

std::vector<VoidRun> operator+(std::vector<VoidRun> a, const std::vector<VoidRun>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(VoidAreas, OneAcrossTilesIsOne) {
  const SwathVoids v =
      judge_voids(box(100, 100, 110, 120, 5, 0) + box(110, 100, 130, 120, 0, 0), covered(0, 0, 240, 240), {}, half_metre, 0.0);
  ASSERT_EQ(v.voids.size(), 1u);
  EXPECT_NEAR(v.voids[0].area, 600.0, 1e-9);
  EXPECT_NEAR(v.voids[0].x, 115.0, 1e-9);
  EXPECT_NEAR(v.voids[0].y, 110.0, 1e-9);
  EXPECT_FALSE(v.voids[0].is_water());
  ASSERT_EQ(v.voids[0].rings.size(), 1u);
  EXPECT_EQ(v.voids[0].rings[0].size(), 4u);
  EXPECT_NEAR(v.least, 4.0, 1e-12);  // (4 x 0.5)^2
  EXPECT_NEAR(v.judged, std::pow(240 - 16, 2), 1e-9);
}

TEST(VoidAreas, SmallOnesAreNone) {
  EXPECT_TRUE(judge_voids(box(100, 100, 101.5, 102.5), covered(0, 0, 240, 240), {}, half_metre, 0.0).voids.empty());  // 3.75 m2
  EXPECT_EQ(judge_voids(box(100, 100, 102, 102), covered(0, 0, 240, 240), {}, half_metre, 0.0).voids.size(), 1u);
}

TEST(VoidAreas, WaterIsApart) {
  const std::vector<VoidRun> pond = box(40, 40, 60, 60, 10, 6), field = box(140, 140, 150, 160, 10, 3);
  std::vector<VoidRun> lake = box(40, 140, 60, 160);
  for (VoidRun& r : lake) r.water = 100;  // of 160 cells a row
  const SwathVoids v = judge_voids(pond + field + lake, covered(0, 0, 240, 240), {}, half_metre, 0.0);
  ASSERT_EQ(v.voids.size(), 3u);
  EXPECT_NEAR(v.area, 200.0, 1e-9);
  EXPECT_NEAR(v.water_area, 800.0, 1e-9);
}

/// A gap of 30 m between two blocks that are open to the outside: a void where gaps of 40 m are looked for, outside where only 20 m are.
TEST(VoidAreas, AGapBetweenSwathsIsAVoid) {
  const std::vector<FootprintCell> west = covered(0, 0, 160, 400), east = covered(192, 0, 352, 400);
  std::vector<FootprintCell> both = west;
  both.insert(both.end(), east.begin(), east.end());
  const std::vector<VoidRun> gap = box(160, -50, 192, 450);
  const SwathVoids v = judge_voids(gap, both, {}, half_metre, 60.0);
  ASSERT_EQ(v.voids.size(), 1u);
  EXPECT_NEAR(v.area, 32 * 400, 0.12 * 32 * 400);  // without the rims, and the discs of the closing at both ends
  EXPECT_EQ(judge_voids(gap, both, {}, half_metre, 10.0).voids.size(), 0u);
}

TEST(VoidAreas, WhatLiesOutsideIsNone) {
  EXPECT_TRUE(judge_voids(box(232, 100, 400, 120), covered(0, 0, 240, 240), {}, half_metre, 20.0).voids.empty());
}

TEST(VoidAreas, ASquareWithoutPointsInTheMiddleIsAVoid) {
  std::vector<FootprintCell> ring;
  for (const FootprintCell& c : covered(0, 0, 480, 480))
    if (!(c.i >= 20 && c.i < 40 && c.j >= 20 && c.j < 40)) ring.push_back(c);
  const SwathVoids v = judge_voids({}, ring, {{160, 160, 320, 320}, {1000, 1000, 1160, 1160}}, half_metre, 0.0);
  ASSERT_EQ(v.voids.size(), 1u);
  EXPECT_NEAR(v.area, 160 * 160, 1e-6);
}

/// The definition, cell by cell: a closing by a disc, what it encloses, and one cell less on all sides.
class Covered {
 public:
  Covered(const std::set<std::pair<int, int>>& cells, int nx, int ny, double reach) : rim_(static_cast<int>(reach) + 3), nx_(nx), ny_(ny) {
    const auto disc = [&](const std::set<std::pair<int, int>>& from, int i, int j) {
      const int r = static_cast<int>(reach);
      for (int dj = -r; dj <= r; ++dj)
        for (int di = -r; di <= r; ++di)
          if (di * di + dj * dj <= reach * reach && from.contains({i + di, j + dj})) return true;
      return false;
    };
    std::set<std::pair<int, int>> beyond;
    for_each([&](int i, int j) {
      if (!disc(cells, i, j)) beyond.insert({i, j});
    });
    std::vector<std::pair<int, int>> open{{-rim_, -rim_}};
    for_each([&](int i, int j) {
      if (cells.contains({i, j}) || (reach >= 0.5 && !disc(beyond, i, j))) closed_.insert({i, j});
    });
    outside_.insert(open.front());
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const std::pair<int, int> next{i + di, j + dj};
        const bool there = next.first >= -rim_ && next.second >= -rim_ && next.first < nx_ + rim_ && next.second < ny_ + rim_;
        if (there && !closed_.contains(next) && outside_.insert(next).second) open.push_back(next);
      }
    }
  }
  bool holds(int i, int j) const {
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        if (outside_.contains({i + di, j + dj})) return false;
    return true;
  }

 private:
  template <class F>
  void for_each(F f) {
    for (int j = -rim_; j < ny_ + rim_; ++j)
      for (int i = -rim_; i < nx_ + rim_; ++i) f(i, j);
  }
  int rim_, nx_, ny_;
  std::set<std::pair<int, int>> closed_, outside_;
};

TEST(VoidAreas, TheFootprintIsThatOfItsDefinition) {
  constexpr int nx = 40, ny = 300;  // more than a band of rows
  std::mt19937 random(7);
  for (const double gap : {0.0, 20.0, 50.0}) {
    std::vector<FootprintCell> cells;
    std::set<std::pair<int, int>> set;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const bool corner = (i == 0 && j == 0) || (i == nx - 1 && j == ny - 1);
        const bool patch = random() % 4 == 0 && (i / 9 + j / 13) % 2 == 0;
        if (corner || patch) cells.push_back({i, j}), set.insert({i, j});
      }
    const Covered expected(set, nx, ny, 0.5 * gap / 8.0);
    std::vector<VoidRun> runs;
    double judged = 0.0, area = 0.0;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const bool is_covered = expected.holds(i, j), is_void = random() % 2 == 0;
        judged += is_covered ? 64.0 : 0.0;
        if (!is_void) continue;
        area += is_covered ? 64.0 : 0.0;
        for (std::int32_t k = 0; k < 64; ++k) runs.push_back({64 * j + k, 64 * i, 64 * (i + 1)});
      }
    const SwathVoids v = judge_voids(runs, cells, {}, half_metre, gap);
    EXPECT_NEAR(v.judged, judged, 1e-6) << gap;
    EXPECT_NEAR(v.area, area, 1e-6) << gap;
    EXPECT_TRUE(gap == 0.0 || judged > 0.0);
  }
}

TEST(VoidAreas, FootprintsHoldFirstReturnsAlone) {
  core::Block b;
  b.x = {1, 2, 17, 33};
  b.y = {1, 1, 1, 1};
  b.z = {0, 0, 0, 0};
  b.return_number = {1, 1, 2, 1};
  EXPECT_EQ(footprint_of(b, 4, half_metre), (std::vector<FootprintCell>{{0, 0}, {4, 0}}));
  EXPECT_EQ(footprint_of(b, 1, half_metre), (std::vector<FootprintCell>{{0, 0}}));
}

}  // namespace
}  // namespace swath::quality
