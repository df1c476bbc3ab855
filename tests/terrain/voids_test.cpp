// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/voids.h"

#include <gtest/gtest.h>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

TEST(Voids, HolesAreLongEdgesAndTheOutsideIsNoData) {
  test::Made m;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i)
      if (i < 10 || i >= 18 || j < 10 || j >= 18) m.add(i + 0.5, j + 0.5, 0.0);
  core::Grid grid(core::Lattice{1.0, 499995, 4599995, 40, 40});
  grid.height[grid.lattice.at(20, 7)] = 1.0f;
  const auto rows = test::all_rows(m.block);
  give_void_reasons(grid, m.block, rows, 10.0);
  EXPECT_EQ(grid.reason[grid.lattice.at(20, 7)], core::Void::none);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) {
      const bool inside = i > 5 && i < 34 && j > 5 && j < 34;  // strictly within the outermost points
      if (i == 20 && j == 7) continue;
      EXPECT_EQ(grid.reason[grid.lattice.at(i, j)], inside ? core::Void::long_edge : core::Void::no_data) << i << " " << j;
    }
  give_void_reasons(grid, m.block, rows, 3.0);
  EXPECT_EQ(grid.reason[grid.lattice.at(19, 19)], core::Void::no_data);  // more than 3 m from any point
}

TEST(Voids, CountsArePerCell) {
  test::Made m;
  m.add(0.0, 0.0, 0.0);  // on the corner: belongs to the cell that begins there
  m.add(0.999, 0.5, 0.0);
  m.add(1.0, 0.5, 0.0);
  m.add(-0.001, 0.5, 0.0);  // outside the window
  m.add(std::nan(""), 0.5, 0.0);
  const core::Lattice window{1.0, 500000, 4600000, 2, 1};
  EXPECT_EQ(count_points(m.block, test::all_rows(m.block), window), (std::vector<std::uint32_t>{2, 1}));
}

TEST(Voids, NeverSeenIsForVoidsAlone) {
  core::Grid g(core::Lattice{1.0, 0, 0, 4, 1});
  g.reason = {core::Void::none, core::Void::no_data, core::Void::long_edge, core::Void::water};
  mark_never_seen(g, {false, true, false, false});
  EXPECT_EQ(g.reason, (std::vector{core::Void::none, core::Void::no_data, core::Void::never_seen, core::Void::water}));
}

}  // namespace
}  // namespace swath::terrain
