// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/map_terrain_files.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/vector/feature_file.h"
#include "io/vector/vector.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

constexpr const char* utm32 = "EPSG:32632";
constexpr double survey_foot = 1200.0 / 3937.0;
constexpr double east = 600000.0, north = 5300000.0;

/// A slope of 10 % to the north over 200 m: contours every 2 m, one spot height, and a breakline with an edge up to it.
void write_slope(const std::filesystem::path& contours, const std::filesystem::path& more, const std::string& crs = utm32) {
  io::ContourWriter writer(contours, crs);
  for (int k = 0; k <= 10; ++k)
    writer.add(core::ContourLine{{east, east + 200}, {north + 20.0 * k, north + 20.0 * k}, 400.0 + 2.0 * k, false, false, false});
  writer.close();
  io::SpatialLayer spots{"spots", "Spot heights", io::SpatialShape::point, false, {}, {}};
  spots.features.push_back({{{east + 52.5, north + 52.5, 412.0}}, {}});
  io::SpatialLayer lines{"ridge", "Breaklines", io::SpatialShape::line, false, {}, {}};
  lines.features.push_back({{{east + 150, north + 85, 409.0}, {east + 150, north + 95, 409.2}}, {}});
  io::write_gpkg(more, {spots, lines}, crs);
}

MapTerrainRequest request(const test::TemporaryFolder& folder, const std::string& contours) {
  MapTerrainRequest r;
  r.files = {folder / contours, folder / "more.gpkg"};
  r.folder = folder / "out";
  return r;
}

TEST(MapTerrainFiles, ContoursSpotHeightsAndBreaklinesOfAnyFileMakeOneModel) {
  for (const char* contours : {"map.gpkg", "map.dxf"}) {
    const test::TemporaryFolder folder;
    write_slope(folder / contours, folder / "more.gpkg");
    const MapTerrainFound found = write_map_terrain(request(folder, contours));
    EXPECT_EQ(found.contours, 11u);
    EXPECT_EQ(found.levels, 11u);
    EXPECT_EQ(found.spots, 1u);
    EXPECT_EQ(found.breaklines, 1u);
    EXPECT_NEAR(found.interval, 2.0, 1e-9);
    const core::Grid g = io::read_grid(folder / "out/dtm.tif");
    const auto at = [&](double x, double y) {
      return g.height[g.lattice.at(static_cast<int>((x + east) / 5.0 - static_cast<double>(g.lattice.i0)),
                                   static_cast<int>((y + north) / 5.0 - static_cast<double>(g.lattice.j0)))];
    };
    EXPECT_NEAR(at(102.5, 152.5), 400.0 + 15.25, 0.01);
    EXPECT_NEAR(at(52.5, 52.5), 412.0, 0.01);
    EXPECT_NEAR(at(148, 92), 409.15, 0.2);
    const core::Grid quality = io::read_grid(folder / "out/dtm_quality.tif");
    EXPECT_FALSE(quality.sigma.empty());
    EXPECT_EQ(test::entries(folder / "out"), 4u);
    EXPECT_NE(map_terrain_text(found).find("11 contours of 11 heights, interval 2 m; 1 spot height, 1 breakline"), std::string::npos);
  }
}

TEST(MapTerrainFiles, WhatHasNoHeightIsCountedAndWhatCannotBeIsRefused) {
  const test::TemporaryFolder folder;
  write_slope(folder / "map.gpkg", folder / "more.gpkg");
  io::SpatialLayer bare{"roads", "", io::SpatialShape::line, true, {}, {}};
  bare.features.push_back({{{east, north, 0}, {east + 10, north, 0}}, {}});
  io::write_gpkg(folder / "roads.gpkg", {bare}, utm32);
  MapTerrainRequest r = request(folder, "map.gpkg");
  r.files.push_back(folder / "roads.gpkg");
  EXPECT_EQ(write_map_terrain(r).without_height, 1u);
  r.files = {folder / "roads.gpkg"};
  r.folder = folder / "none";
  EXPECT_THROW(write_map_terrain(r), core::Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
  r = request(folder, "map.gpkg");
  r.crs = "EPSG:4326";
  EXPECT_THROW(write_map_terrain(r), core::Error);
  r = request(folder, "absent.gpkg");
  EXPECT_THROW(write_map_terrain(r), core::Error);
}

TEST(MapTerrainFiles, LengthsInFeetAreFeetInTheFileAndMetresInTheAnswer) {
  const test::TemporaryFolder folder;
  write_slope(folder / "map.gpkg", folder / "more.gpkg", "EPSG:2225+6360");  // California zone 1, feet; NAVD88, US survey feet
  MapTerrainRequest r = request(folder, "map.gpkg");
  r.cell = 5.0 * survey_foot;
  const MapTerrainFound found = write_map_terrain(r);
  EXPECT_NEAR(io::read_grid(folder / "out/dtm.tif").lattice.cell, 5.0, 1e-9);
  EXPECT_NEAR(found.cell, r.cell, 1e-12);
  const std::string json = test::read_bytes(folder / "out/map_terrain.json");
  for (const char* part : {"\"units\": \"m\"", "\"dtm_height_unit\": \"ftUS\""}) EXPECT_NE(json.find(part), std::string::npos) << json;
  EXPECT_NEAR(found.interval, 2.0 * survey_foot, 1e-9);
  EXPECT_NEAR(io::height_unit_of(folder / "out/dtm.tif"), survey_foot, 1e-9);
  EXPECT_NE(map_terrain_text(found).find("interval 0.609601 m"), std::string::npos) << map_terrain_text(found);
  EXPECT_NE(map_terrain_text(found).find("heights of the model in ftUS; lengths and errors in m"), std::string::npos);
}

TEST(MapTerrainFiles, AUnitOfHeightsThatIsNotStatedIsAskedForWhereTheMapIsInFeet) {
  const test::TemporaryFolder folder;
  io::SpatialLayer lines{"contours", "", io::SpatialShape::line, true, {{"height", 0.0}}, {}};
  for (int k = 0; k <= 10; ++k)
    lines.features.push_back({{{east, north + 20.0 * k, 0}, {east + 200, north + 20.0 * k, 0}}, {400.0 + 2.0 * k}});
  io::write_gpkg(folder / "map.gpkg", {lines}, "EPSG:2225");
  MapTerrainRequest r = request(folder, "map.gpkg");
  r.files.pop_back();
  EXPECT_THROW(write_map_terrain(r), core::Error);
  r.height_unit = survey_foot;
  EXPECT_NEAR(write_map_terrain(r).interval, 2.0 * survey_foot, 1e-9);
  EXPECT_NEAR(io::height_unit_of(folder / "out/dtm.tif"), survey_foot, 1e-9);
  r.height_unit = 1.0;
  EXPECT_NEAR(write_map_terrain(r).interval, 2.0, 1e-9);
  EXPECT_NEAR(io::height_unit_of(folder / "out/dtm.tif"), 1.0, 1e-9);
}

}  // namespace
}  // namespace swath::pipeline
