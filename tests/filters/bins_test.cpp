// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/bins.h"

#include <gtest/gtest.h>

#include <array>

namespace swath::filters {
namespace {

core::Block some_points() {
  core::Block b;
  b.origin = {500000.25, 5000000.0, 0.0};
  b.x = {-3.0, 0.0, 4.9, 0.1};
  b.y = {1.0, 0.0, -7.0, 0.2};
  b.z = {10, 20, 30, 40};
  return b;
}

TEST(Bins, CellsLieOnWholeMultiplesInMapCoordinates) {
  const core::Lattice l = lattice_around(some_points(), 2.0, 1);
  EXPECT_EQ(l.i0, 249998 - 1);  // 499997.25 / 2
  EXPECT_EQ(l.j0, 2499996 - 1);
  EXPECT_EQ(l.nx, 250002 - 249998 + 1 + 2);
  EXPECT_EQ(l.ny, 2500000 - 2499996 + 1 + 2);
  EXPECT_EQ(lattice_around({}, 2.0, 3).size(), 0u);
}

TEST(Bins, ALatticeAroundSomePointsHoldsThemAlone) {
  const core::Lattice l = lattice_around(some_points(), std::vector<std::uint8_t>{0, 1, 0, 1}, 2.0, 1);
  EXPECT_EQ(l.i0, 250000 - 1);
  EXPECT_EQ(l.j0, 2500000 - 1);
  EXPECT_EQ(l.nx, 3);
  EXPECT_EQ(l.ny, 3);
  EXPECT_EQ(lattice_around(some_points(), std::vector<std::uint8_t>(4, 0), 2.0, 1).size(), 0u);
}

TEST(Bins, CellsOfManyPointsAreThoseOfEach) {
  const core::Block b = some_points();
  const core::Lattice l = lattice_around(b, 2.0, 1);
  std::array<std::int32_t, 3> column{}, row{};
  cells_of(l, b, 1, 3, column.data(), row.data());
  for (size_t k = 0; k < 3; ++k) {
    const CellIndex c = cell_of(l, b, k + 1);
    EXPECT_EQ(column[k], c.i);
    EXPECT_EQ(row[k], c.j);
  }
}

TEST(Bins, EveryPointIsInItsCellOnce) {
  const core::Block b = some_points();
  const Bins bins(b, 2.0, 1, [](size_t p) { return p != 2; });
  size_t found = 0;
  for (int j = 0; j < bins.lattice().ny; ++j)
    for (int i = 0; i < bins.lattice().nx; ++i)
      for (const std::uint32_t p : bins.rows(i, j)) {
        ++found;
        const CellIndex c = cell_of(bins.lattice(), b, p);
        EXPECT_EQ(c.i, i);
        EXPECT_EQ(c.j, j);
      }
  EXPECT_EQ(found, 3u);
  const CellIndex c = cell_of(bins.lattice(), b, 1);
  ASSERT_EQ(bins.in(c.i, c.j).size(), 2u);
  EXPECT_EQ(bins.in(c.i, c.j)[1].z, 40.0);
}

}  // namespace
}  // namespace swath::filters
