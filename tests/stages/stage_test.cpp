// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stage.h"

#include <gtest/gtest.h>

#include "tests/world/support.h"

namespace swath::stages {
namespace {

TEST(Stage, EveryCellBelongsToExactlyOneTile) {
  // Tiles whose side is no multiple of the cell: the cells of neighbours neither overlap nor leave a gap.
  const double cell = 0.7, side = 10.0;
  std::int64_t next = 0;
  for (int k = -3; k < 4; ++k) {
    const core::Lattice l = lattice_in(cell, {k * side, 0, (k + 1) * side, side});
    if (k > -3) {
      EXPECT_EQ(l.i0, next);
    }
    next = l.i0 + l.nx;
    for (int i = 0; i < l.nx; ++i) {
      EXPECT_GE(l.centre_x(i), k * side);
      EXPECT_LT(l.centre_x(i), (k + 1) * side);
    }
  }
}

TEST(Stage, FilesOfEarlierStagesAreFoundTheNewestFirst) {
  const test::TemporaryFolder folder;
  const io::Survey survey;
  Context c{survey};
  EXPECT_TRUE(c.made("a.gpkg").empty());
  c.earlier = {folder / "1", folder / "2", folder / "3"};
  test::write_bytes(folder / "1/a.gpkg", "one");
  test::write_bytes(folder / "2/a.gpkg", "two");
  EXPECT_EQ(c.made("a.gpkg"), folder / "2/a.gpkg");
  EXPECT_TRUE(c.made("b.gpkg").empty());
}

TEST(Stage, LabelsAreCorners) {
  const io::Survey survey;
  Context c{survey};
  c.tile_side = 250;
  EXPECT_EQ(c.label({2, -3}), "500_-750");
  c.tile_side = 30.48;
  EXPECT_EQ(c.label({1, 0}), "30480mm_0");
  c.unit = 0.3048;
  EXPECT_EQ(c.label({1, -2}), "100_-200");
  c.tile_side = 500;  // 1640.42 ft
  EXPECT_EQ(c.label({1, 2}), "1640_3281");
}

}  // namespace
}  // namespace swath::stages
