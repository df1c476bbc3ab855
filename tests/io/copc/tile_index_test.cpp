// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/tile_index.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "core/error.h"
#include "core/time.h"
#include "io/text/value_file.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// 100 points a square metre apart from 0.5 m on, with two returns of every second pulse.
core::Block made_block(double x0) {
  core::Block b;
  b.origin = {x0, 5400000.0, 100.0};
  for (int i = 0; i < 100; ++i) {
    b.x.push_back(i % 10 + 0.5), b.y.push_back(i / 10 + 0.5), b.z.push_back(i * 0.1);
    b.time.push_back(1.4e9 + i);
    b.return_number.push_back(static_cast<std::uint8_t>(1 + i % 2));
    b.classification.push_back(i < 30 ? 2 : 5);
  }
  return b;
}

TileIndex made_index() {
  TileFactsOf a, b, empty;
  a.add(made_block(500000.0));
  b.add(made_block(500500.0));
  b.add(made_block(500520.0));
  TileIndex index{
      {{"a.laz", a.facts()}, {"b.laz", b.facts()}, {"c.laz", empty.facts()}}, "EPSG:25832+7837", 1.0, 1.0, "2026-01-02T00:00:00Z"};
  return index;
}

TEST(TileIndex, FactsAreThoseOfAllBlocks) {
  const TileFacts f = made_index().tiles[1].facts;
  EXPECT_EQ(f.points, 200u);
  EXPECT_EQ(f.first_returns, 100u);
  EXPECT_EQ(f.classes[2], 60u);
  EXPECT_EQ(f.classes[5], 140u);
  EXPECT_EQ(f.first_time, 1.4e9);
  EXPECT_EQ(f.last_time, 1.4e9 + 99.0);
  EXPECT_DOUBLE_EQ(f.low[0], 500500.5);
  EXPECT_DOUBLE_EQ(f.high[0], 500529.5);
  EXPECT_DOUBLE_EQ(f.high[2], 109.9);
  EXPECT_DOUBLE_EQ(f.density(), 1.0);
  EXPECT_EQ(made_index().tiles[2].facts.density(), 0.0);
}

TEST(TileIndex, TheVirtualPointCloudListsTilesWithPoints) {
  const test::TemporaryFolder folder;
  LasHeader h;
  h.compressed = true;
  LasExtra e;
  e.name = "sigma_v", e.type = 5, e.scale = {{0.0001, 0, 0}};
  h.extras = {e};
  write_vpc(folder / "a.vpc", made_index(), h);
  const core::Value list = parse_json(read_text_file(folder / "a.vpc"), "a.vpc");
  ASSERT_EQ(list.find("features")->items().size(), 2u);
  const core::Value& item = list.find("features")->items()[0];
  EXPECT_EQ(item.find("assets")->find("data")->find("href")->as_text(), "./a.laz");
  const core::Value& p = *item.find("properties");
  EXPECT_EQ(p.find("pc:count")->as_int(), 100);
  EXPECT_EQ(p.find("datetime")->as_text(), core::utc_text(1.4e9));
  EXPECT_EQ(p.find("pc:schemas")->items().back().find("type")->as_text(), "floating");
  EXPECT_EQ(p.find("swath:classes")->items().size(), 2u);
  EXPECT_DOUBLE_EQ(p.find("proj:bbox")->items()[0].as_number(), 500000.5);
  // 500 km east of the zone's edge is its meridian, 9 degrees; 5400 km north of the equator lies at 48.75 degrees.
  const auto& box = item.find("bbox")->items();
  EXPECT_NEAR(box[0].as_number(), 9.0, 1e-4);
  EXPECT_NEAR(box[1].as_number(), 48.7526, 1e-3);
  EXPECT_LT(box[0].as_number(), box[2].as_number());
  const auto& ring = item.find("geometry")->find("coordinates")->items()[0].items();
  EXPECT_EQ(ring.size(), 33u);
  EXPECT_EQ(ring.front().items()[0].as_number(), ring.back().items()[0].as_number());
}

TEST(TileIndex, TimesThatAreUnknownGiveWayToTheDate) {
  const test::TemporaryFolder folder;
  TileIndex index = made_index();
  index.tiles[0].facts.first_time = TileFacts::none, index.tiles[0].facts.last_time = -TileFacts::none;
  write_vpc(folder / "a.vpc", index, {});
  const core::Value list = parse_json(read_text_file(folder / "a.vpc"), "a.vpc");
  const core::Value& p = *list.find("features")->items()[0].find("properties");
  EXPECT_EQ(p.find("datetime")->as_text(), index.date);
  EXPECT_EQ(p.find("start_datetime"), nullptr);
  index.crs = "LOCAL_CS[\"of the site\",UNIT[\"metre\",1]]";
  EXPECT_THROW(write_vpc(folder / "b.vpc", index, {}), core::Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.vpc"));
}

TEST(TileIndex, TheMapOfTilesHasABoxWithNumbersForEach) {
  const test::TemporaryFolder folder;
  write_tile_layer(folder / "a.gpkg", made_index());
  write_tile_layer(folder / "b.gpkg", made_index());
  EXPECT_EQ(read_text_file(folder / "a.gpkg"), read_text_file(folder / "b.gpkg")) << "equal bytes";
  const Dataset set = open_vector(folder / "a.gpkg");
  ASSERT_TRUE(set);
  OGRLayer* layer = set->GetLayerByName("tiles");
  ASSERT_TRUE(layer);
  EXPECT_EQ(layer->GetFeatureCount(), 2);
  const std::unique_ptr<OGRFeature> f(layer->GetNextFeature());
  EXPECT_STREQ(f->GetFieldAsString("name"), "a.laz");
  EXPECT_EQ(f->GetFieldAsDouble("points"), 100.0);
  EXPECT_EQ(f->GetFieldAsDouble("first_returns"), 50.0);
  EXPECT_DOUBLE_EQ(f->GetFieldAsDouble("points_per_m2"), 1.0);
  EXPECT_STREQ(f->GetFieldAsString("classes"), "2: 30, 5: 70");
  EXPECT_EQ(f->GetFieldAsString("first_time"), core::utc_text(1.4e9));
  ASSERT_EQ(wkbFlatten(f->GetGeometryRef()->getGeometryType()), wkbPolygon);
  EXPECT_NEAR(f->GetGeometryRef()->toPolygon()->get_Area(), 81.0, 1e-9);
}

}  // namespace
}  // namespace swath::io
