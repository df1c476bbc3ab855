// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/cell_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

namespace swath::quality {
namespace {

/// A 5 x 5 lattice of returns over a cell of 2 m on the plane 10 + 0.2 x - 0.1 y.
PlaneSums lattice(double west = 0.0) {
  PlaneSums s;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const double x = west + 0.2 + 0.4 * i, y = 0.2 + 0.4 * j;
      s.add(x, y, 10.0 + 0.2 * x - 0.1 * y);
    }
  return s;
}

TEST(CellPlanes, APlaneIsFoundExactly) {
  const auto p = plane_of(lattice(), 1.0, 1.0, 2.0);
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->height, 10.1, 1e-12);
  EXPECT_NEAR(p->east, 0.2, 1e-12);
  EXPECT_NEAR(p->north, -0.1, 1e-12);
  EXPECT_NEAR(p->rms, 0.0, 1e-6);  // a root of rounding errors
  EXPECT_NEAR(p->slope_squared(), 0.05, 1e-12);
}

TEST(CellPlanes, SumsOfPartsAreThoseOfTheWhole) {
  PlaneSums two = lattice();
  two.add(lattice());
  EXPECT_EQ(two.n, 50.0);
  EXPECT_NEAR(plane_of(two, 1.0, 1.0, 2.0)->height, 10.1, 1e-12);
}

TEST(CellPlanes, ReturnsBesideTheCentreOrInARowAreNoPlane) {
  EXPECT_FALSE(plane_of(lattice(3.0), 1.0, 1.0, 2.0));
  PlaneSums row;
  for (int k = 0; k < 20; ++k) row.add(0.1 * k, 1.0 + 1e-4 * k, 5.0);
  EXPECT_FALSE(plane_of(row, 1.0, 1.0, 2.0));
}

/// Chi square with 2 degrees has its lower quartile at -2 ln 0.75.
TEST(CellPlanes, TheQuartileOfChiSquare) {
  EXPECT_NEAR(quartile_of(2.0), std::sqrt(-2.0 * std::log(0.75) / 2.0), 0.01);
  EXPECT_NEAR(quartile_of(1e6), 1.0, 1e-3);
}

TEST(CellPlanes, OnlyUsableSingleReturnsCount) {
  core::Block b;
  b.x.assign(4, 0.0), b.y = b.z = b.x;
  b.return_number = {1, 1, 2, 1};
  b.return_count = {1, 2, 2, 1};
  b.flags = {0, 0, 0, core::flag::withheld};
  EXPECT_TRUE(is_single(b, 0));
  for (size_t p = 1; p < 4; ++p) EXPECT_FALSE(is_single(b, p)) << p;
}

/// As one sort by cell, line, place and sigma has them, whatever the order of the points; those of no cell are left out.
TEST(CellPlanes, ReturnsByCellStandInTheOrderOfCellLineAndPlace) {
  constexpr std::uint32_t cells = 5;
  std::mt19937 random(7);
  std::vector<std::pair<std::uint32_t, CellReturn>> points;
  const auto one_of = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int k = 0; k < 400; ++k)  // few values, so that many are equal in part
    points.push_back(
        {one_of(6) == 0 ? no_cell : one_of(cells - 1),  // the last cell stays empty
         {1.0 * one_of(2), 1.0 * one_of(2), 1.0 * one_of(2), static_cast<float>(one_of(2)), static_cast<std::uint16_t>(one_of(3))}});
  using Row = std::tuple<std::uint32_t, int, double, double, double, float>;
  const auto row = [](std::uint32_t cell, const CellReturn& r) { return Row(cell, r.line, r.x, r.y, r.z, r.sigma); };
  std::vector<Row> expected;
  for (const auto& [cell, r] : points)
    if (cell != no_cell) expected.push_back(row(cell, r));
  std::sort(expected.begin(), expected.end());
  for (int round = 0; round < 2; ++round) {
    const ReturnsByCell returns(
        points.size(), cells, [&](size_t p) { return points[p].first; }, [&](size_t p) { return points[p].second; });
    std::vector<Row> found;
    for (std::uint32_t c = 0; c < cells; ++c)
      for (const CellReturn& r : returns.in(c)) found.push_back(row(c, r));
    EXPECT_EQ(found, expected);
    EXPECT_TRUE(returns.in(cells - 1).empty());
    std::shuffle(points.begin(), points.end(), random);
  }
}

}  // namespace
}  // namespace swath::quality
