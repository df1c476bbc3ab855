// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/structure_cells.h"

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
  const StructureCells c = structure_cells(b, {Planar::wide, Planar::some, Planar::none, Planar::none, Planar::none});
  EXPECT_EQ(c.plane[0], 6.0f);
  EXPECT_EQ(c.height[0], 5.0f);
  EXPECT_EQ(c.ground[0], 1.0f);
  EXPECT_EQ(c.low[0], 1.0f);
  EXPECT_EQ(c.kind[0], Planar::wide);
  EXPECT_EQ(c.kind[1], Planar::none);
  EXPECT_FALSE(c.has_plane(1));
  EXPECT_EQ(c.ground[1], 2.0f);
}

TEST(StructureCells, GrowingCrossesOneEmptyCellAndStaysInItsSquare) {
  const core::Lattice l{1.0, 0, 0, 40, 3};
  const auto cells_from = [&](int start, int radius, auto&& is) {
    int most = 0;
    grow(
        l, start, 1, radius, structure_link, [&](size_t, size_t to) { return is(static_cast<int>(to % 40), static_cast<int>(to / 40)); },
        [&](size_t, int n) {
          most = n;
          return false;
        });
    return most;
  };
  const auto every_second = [](int i, int j) { return j == 1 && i % 2 == 0; };
  EXPECT_EQ(cells_from(20, 10, every_second), 11);
  EXPECT_EQ(cells_from(0, 100, every_second), 20);
  EXPECT_EQ(cells_from(0, 100, [](int i, int j) { return j == 1 && i % 3 == 0; }), 1);
  EXPECT_TRUE(grow(
      l, 0, 1, 5, structure_link, [](size_t, size_t) { return true; }, [](size_t, int n) { return n >= 9; }));
  EXPECT_FALSE(grow(
      l, 0, 1, 5, structure_link, [](size_t, size_t) { return false; }, [](size_t, int n) { return n >= 2; }));
}

}  // namespace
}  // namespace swath::filters
