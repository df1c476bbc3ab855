// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/structure_cells.h"

#include <gtest/gtest.h>

namespace swath::filters {
namespace {

TEST(StructureCells, HighestPlanarPointAndLowestGround) {
  core::Block b;
  core::resize(b, 5);
  core::add_columns(b, {core::Column::classification, core::Column::height});
  b.x = {0.2, 0.8, 0.5, 0.4, 1.5};
  b.y = {0.5, 0.5, 0.5, 0.5, 0.5};
  b.z = {5.0, 6.0, 9.0, 1.0, 2.0};
  b.height = {4.0f, 5.0f, 8.0f, 0.0f, 0.0f};
  b.classification = {1, 1, 1, core::point_class::ground, core::point_class::ground};
  const StructureCells c =
      structure_cells(b, {Planar::wide, Planar::some, Planar::none, Planar::none, Planar::none}, {structure_cell, 0, 0, 2, 1});
  EXPECT_EQ(c.plane[0], 6.0f);
  EXPECT_EQ(c.height[0], 5.0f);
  EXPECT_EQ(c.ground[0], 1.0f);
  EXPECT_EQ(c.low[0], 1.0f);
  EXPECT_EQ(c.kind[0], Planar::wide);
  EXPECT_EQ(c.kind[1], Planar::none);
  EXPECT_FALSE(c.has_plane(1));
  EXPECT_EQ(c.ground[1], 2.0f);
}

TEST(StructureCells, OpenCellsAreReadAcrossWords) {
  const core::Lattice l{1.0, 0, 0, 200, 2};
  const auto is_open = [](int i, int j) { return (7 * i + 3 * j) % 5 < 2; };
  OpenCells cells(l, [&](size_t c) { return is_open(static_cast<int>(c % 200), static_cast<int>(c / 200)); });
  cells.close(64, 1);
  cells.open(64, 1);
  cells.close(63, 0);
  for (int j = 0; j < 2; ++j)
    for (const auto& [west, east] : {std::pair{0, 0}, std::pair{0, 62}, std::pair{60, 68}, std::pair{127, 128}, std::pair{150, 199}}) {
      const std::uint64_t row = cells.in_row(west, east, j);
      EXPECT_EQ(row >> (east - west + 1), 0u);
      for (int i = west; i <= east; ++i) EXPECT_EQ(row >> (i - west) & 1, is_open(i, j) && !(i == 63 && j == 0)) << i << " " << j;
    }
}

TEST(StructureCells, GrowingCrossesOneEmptyCellAndStaysInItsSquare) {
  const core::Lattice l{1.0, 0, 0, 40, 3};
  const auto cells_from = [&](int start, int radius, size_t wanted, auto&& is) {
    Growth growth(l, radius, [&](size_t c) { return is(static_cast<int>(c % 40), static_cast<int>(c / 40)); });
    const auto linked = [&](size_t, size_t) { return true; };
    growth.from(start, 1, structure_link, 3, linked);  // what went before does not matter
    return growth.from(start, 1, structure_link, wanted, linked).size();
  };
  const auto every_second = [](int i, int j) { return j == 1 && i % 2 == 0; };
  EXPECT_EQ(cells_from(20, 10, 1000, every_second), 11u);
  EXPECT_EQ(cells_from(0, 100, 1000, every_second), 20u);
  EXPECT_EQ(cells_from(0, 100, 1000, [](int i, int j) { return j == 1 && i % 3 == 0; }), 1u);
  EXPECT_EQ(cells_from(0, 5, 9, [](int, int) { return true; }), 9u);
  EXPECT_EQ(cells_from(0, 5, 1000, [](int, int) { return true; }), 18u);
}

}  // namespace
}  // namespace swath::filters
