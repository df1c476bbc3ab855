// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/height_grid.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

struct Flight {
  test::TieWorld world;
  test::Flown flown;
  trajectory::Trajectory trajectory;

  explicit Flight(test::TieWorld w, const std::vector<test::Track>& tracks)
      : world(std::move(w)), flown(test::fly(world, tracks, 5)), trajectory(flown.data) {}
  LocalPoints points() const { return {world.scanner, world.truth, trajectory, world.frame}; }
};

test::TieWorld small_world() {
  test::TieWorld w;
  w.slope = 0.1;
  w.prf = 10000.0;
  return w;
}

TEST(HeightGrid, CellsHoldMeansOfLastReturns) {
  Flight f(small_world(), {{{0, 0}, 200, 0.4, 120}});
  // Every fifth pulse is made the first return of two: it must not count.
  core::Shots& shots = f.flown.lines[0].second;
  for (size_t i = 0; i < shots.size(); i += 5) shots.return_count[i] = 2, shots.range[i] -= 50.0;
  LocalPoints points = f.points();
  const HeightGrids g = height_grids(f.flown.stream(777), points, 2.0, 1u << 24);
  ASSERT_EQ(g.views.size(), 1u);
  EXPECT_DOUBLE_EQ(g.cell, 2.0);
  std::map<std::pair<long, long>, std::pair<double, int>> cells;
  PointColumns p;
  points.run(shots, p);
  for (size_t i = 0; i < shots.size(); ++i) {
    if (i % 5 == 0) continue;
    auto& [sum, n] = cells[{std::lround(std::floor(p.x[i] / 2.0)), std::lround(std::floor(p.y[i] / 2.0))}];
    sum += p.z[i], ++n;
  }
  const Raster r = g.views[0].raster(-30, -30, 60, 60, 1);
  constexpr double single_precision = 1e-5;  // m
  int filled = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const auto at = cells.find({x - 30, y - 30});
      const float z = r.z[static_cast<size_t>(y * 60 + x)];
      ASSERT_EQ(std::isnan(z), at == cells.end()) << x << " " << y;
      if (at == cells.end()) continue;
      ++filled;
      EXPECT_NEAR(static_cast<double>(z), at->second.first / at->second.second, single_precision);
    }
  EXPECT_GT(filled, 2000);
}

TEST(HeightGrid, TheBudgetCoarsensAndBlocksOfCellsAreTheSameMeans) {
  const Flight f(small_world(), {{{0, 0}, 200, 0.4, 120}});
  LocalPoints points = f.points();
  const HeightGrids fine = height_grids(f.flown.stream(), points, 1.5, 1u << 24);
  const HeightGrids coarse = height_grids(f.flown.stream(), points, 1.5, 256 * 30);
  EXPECT_DOUBLE_EQ(fine.cell, 1.5);
  const int factor = static_cast<int>(std::lround(coarse.cell / fine.cell));
  EXPECT_GT(factor, 1);
  EXPECT_DOUBLE_EQ(coarse.cell, 1.5 * factor);
  EXPECT_EQ(fine.returns, coarse.returns);
  const Raster a = fine.views[0].raster(-10, -10, 20, 20, factor), b = coarse.views[0].raster(-10, -10, 20, 20, 1);
  constexpr double single_precision = 2e-5;  // m
  for (size_t c = 0; c < a.z.size(); ++c) {
    ASSERT_EQ(std::isnan(a.z[c]), std::isnan(b.z[c]));
    if (!std::isnan(a.z[c])) {
      EXPECT_NEAR(static_cast<double>(a.z[c]), static_cast<double>(b.z[c]), single_precision);
    }
  }
  // Sparse returns widen the cell by themselves.
  EXPECT_GT(height_grids(f.flown.stream(), points, 0.1, 1u << 28).cell, 0.5);
}

TEST(HeightGrid, AConeSeesAPlaceTwice) {
  test::TieWorld w = small_world();
  w.scanner.model = core::ScannerModel::conical;
  const Flight f(w, {{{0, 0}, 200, 0.4, 120}, {{0, 0}, 200, 1.4, 120}});
  LocalPoints points = f.points();
  const HeightGrids g = height_grids(f.flown.stream(), points, 2.0, 1u << 24);
  ASSERT_EQ(g.views.size(), 4u);
  int astern = 0;
  for (const HeightView& v : g.views) astern += v.astern;
  EXPECT_EQ(astern, 2);
}

}  // namespace
}  // namespace swath::calib
