// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/cell_planes.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace swath::quality
