// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/map_overview.h"

#include <gtest/gtest.h>

#include "stages/grid_tile.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

/// Two tiles of 100 m beside each other, heights that grow by 1 per m eastward, none in the second's northern half.
struct TwoTiles {
  test::TemporaryFolder folder;
  io::Survey survey;
  Context context{survey};
  std::vector<TileKey> tiles{{-1, 0}, {0, 0}};
  TwoTiles() {
    context.tile_side = 100.0;
    for (const TileKey key : tiles) {
      core::Grid g(lattice_in(2.0, context.box_of(key)));
      for (int j = 0; j < g.lattice.ny; ++j)
        for (int i = 0; i < g.lattice.nx; ++i) {
          if (key.ix == 0 && j >= 25) continue;
          g.height[g.lattice.at(i, j)] = static_cast<float>(g.lattice.centre_x(i));
          g.reason[g.lattice.at(i, j)] = core::Void::none;
        }
      write_grid_tile(folder.path(), key, g);
    }
  }
};

TEST(MapOverview, IsTheWholeWhereItFits) {
  const TwoTiles t;
  const core::Grid g = overview_of(t.folder.path(), t.tiles, 2.0);
  EXPECT_EQ(g.lattice, (core::Lattice{2.0, -50, 0, 100, 50}));
  EXPECT_FLOAT_EQ(g.height[g.lattice.at(0, 0)], -99.0F);
  EXPECT_EQ(g.reason[g.lattice.at(99, 49)], core::Void::no_data);
}

TEST(MapOverview, EndsWhereNothingLies) {
  TwoTiles t;
  t.tiles = {{0, 0}};  // its southern half alone has heights
  const core::Grid g = overview_of(t.folder.path(), t.tiles, 2.0);
  EXPECT_EQ(g.lattice, (core::Lattice{2.0, 0, 0, 50, 25}));
  EXPECT_EQ(g.count[g.lattice.at(49, 24)], 1u);
}

TEST(MapOverview, FollowsASmallCloudAndNotItsTile) {
  const TwoTiles t;
  core::Grid small(lattice_in(0.5, t.context.box_of({0, 0})));
  for (int j = 40; j < 60; ++j)
    for (int i = 30; i < 60; ++i) small.height[small.lattice.at(i, j)] = 1.0F, small.reason[small.lattice.at(i, j)] = core::Void::none;
  write_grid_tile(t.folder.path() / "small", {0, 0}, small);
  const core::Grid g = overview_of(t.folder.path() / "small", {{0, 0}}, 0.5, 100);
  EXPECT_EQ(g.lattice, (core::Lattice{0.5, 30, 40, 30, 20})) << "cells of 0.5 m, though the tile has 200 of them a side";
}

TEST(MapOverview, IsAveragedWhereItDoesNot) {
  const TwoTiles t;
  const core::Grid g = overview_of(t.folder.path(), t.tiles, 2.0, 20);
  EXPECT_EQ(g.lattice, (core::Lattice{10.0, -10, 0, 20, 10}));
  EXPECT_FLOAT_EQ(g.height[g.lattice.at(0, 0)], -95.0F);
  EXPECT_EQ(g.count[g.lattice.at(0, 0)], 25u);
  EXPECT_EQ(g.reason[g.lattice.at(15, 9)], core::Void::no_data);
  EXPECT_EQ(overview_of(t.folder.path(), {}, 2.0).lattice.size(), core::Lattice().size());
}

}  // namespace
}  // namespace swath::stages
