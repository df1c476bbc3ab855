// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/fullest_tile.h"

#include "io/las/las_writer.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

/// A survey with a cloud of n points between two corners.
struct Cloud {
  test::TemporaryFolder folder;
  io::Survey survey;
  stages::Context context{survey};

  Cloud(size_t n, double x0, double x1) {
    io::LasWriteOptions o;
    o.threads = 1;
    io::LasWriter writer(folder / "a.las", o);
    core::Block b;
    for (size_t i = 0; i < n; ++i) {
      b.x.push_back(i % 2 ? x0 : x1);
      b.y.push_back(5300100.0);
      b.z.push_back(10.0);
    }
    writer.write(b);
    writer.finish();
    io::PointFile& f = survey.points.emplace_back();
    f.file = folder / "a.las";
    f.crs = "EPSG:32632";
    context.crs = core::Crs("EPSG:32632");
    context.tile_side = 500.0;
  }
};

TEST(FullestTile, HoldsItsShareOfAFilesPoints) {
  const Cloud c(3000, 500100.0, 501400.0);
  const auto tile = fullest_tile(c.context);
  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->points, 1000u);
  EXPECT_EQ(tile->key, (stages::TileKey{1000, 10600}));
}

TEST(FullestTile, PointsAreSpreadEvenlyOverTheirBox) {
  const Cloud c(3000, 500250.0, 501250.0);
  const std::map<stages::TileKey, std::uint64_t> expected{{{1000, 10600}, 750}, {{1001, 10600}, 1500}, {{1002, 10600}, 750}};
  EXPECT_EQ(even_tiles(c.context), expected);
}

TEST(FullestTile, PointsOnTheRimAreInTheTileWithin) {
  const Cloud c(3000, 500000.0, 500500.0);
  EXPECT_EQ(fullest_tile(c.context)->points, 3000u);
}

TEST(FullestTile, NothingIsKnownWhereTheAreaLeavesPointsOut) {
  Cloud c(3000, 500100.0, 500400.0);
  c.context.area.box.x1 = 500200.0;
  EXPECT_FALSE(fullest_tile(c.context));
  Cloud high(3000, 500100.0, 500400.0);
  EXPECT_TRUE(fullest_tile(high.context));
  high.context.area.highest = -1e3;
  EXPECT_FALSE(fullest_tile(high.context));
}

}  // namespace
}  // namespace swath::pipeline
