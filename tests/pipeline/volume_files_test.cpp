// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/volume_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

/// A heap in the form of a cone, 5 m high, of radius 20 m (ft in feet), on ground at 100.
core::Grid heap(const core::Lattice& l, double height) {
  core::Grid g(l);
  const double cx = 0.5 * (l.west() + l.east()), cy = 0.5 * (l.south() + l.north());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const double r = std::hypot(l.centre_x(i) - cx, l.centre_y(j) - cy);
      g.height[l.at(i, j)] = static_cast<float>(100.0 + height * std::max(0.0, 1.0 - r / 20.0));
      g.reason[l.at(i, j)] = core::Void::none;
    }
  g.sigma.assign(l.size(), 0.03f);
  g.count.assign(l.size(), 1);
  return g;
}

const double cone = M_PI * 400.0 * 5.0 / 3.0;
constexpr double tolerance = 2e-3;  // of the midpoint rule at the rim and the tip, cells of 0.5 and 1

double number(const VolumesFound& v, const char* key) { return core::reported(v).find(key)->as_number(); }

void write(const std::filesystem::path& folder, const std::string& name, const core::Grid& g, const std::string& crs) {
  io::write_grid(folder / (name + ".tif"), g, crs);
  io::write_grid(folder / (name + "_quality.tif"), g, crs, io::quality_bands);
}

TEST(VolumeFiles, TwoModelsOnDifferentLattices) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 0.0), "EPSG:32632");
  write(folder.path(), "b", heap({0.5, 1200000, 10600000, 120, 120}, 5.0), "EPSG:32632");
  const VolumesFound v = volumes_of({folder / "a.tif", folder / "b.tif", {}, {}, 1.0});
  EXPECT_NEAR(number(v, "fill"), cone, tolerance * cone);
  EXPECT_EQ(number(v, "cut"), 0.0);
  EXPECT_EQ(number(v, "cell"), 0.5);
  EXPECT_NEAR(number(v, "sigma_net"), number(v, "area") * 0.03 * std::sqrt(2.0), 1e-3 * number(v, "area"));
  EXPECT_GT(v.volumes.left_out, 0u);  // the border of half a coarse cell
  EXPECT_NE(volume_text(v).find("m3"), std::string::npos);
}

TEST(VolumeFiles, DesignHeightInsideAPolygon) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 5.0), "EPSG:32632");
  test::write_bytes(folder / "half.geojson",
                    R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[{"type":"Feature",
"properties":{},"geometry":{"type":"Polygon","coordinates":[[[600000,5300000],[600030,5300000],[600030,5300060],[600000,5300060],
[600000,5300000]]]}}]})");
  const VolumesFound v = volumes_of({folder / "a.tif", {}, 100.0, folder / "half.geojson", 0.0});
  EXPECT_NEAR(number(v, "cut"), 0.5 * cone, tolerance * cone);
  EXPECT_NEAR(number(v, "area"), 1800.0, 1e-6);
  EXPECT_NEAR(number(v, "sigma_net"), 0.03 * std::sqrt(1800.0), 1e-4);
}

TEST(VolumeFiles, WildVerticesOfAPolygonAreLeftOutAndCounted) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 5.0), "EPSG:32632");
  for (const char* wild : {"[1e300,5300000]", "[600030,1e12]", "[NaN,5300000]"}) {
    test::write_bytes(folder / "half.geojson",
                      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[{"type":"Feature",
"properties":{},"geometry":{"type":"Polygon","coordinates":[[[600000,5300000],)" +
                          std::string(wild) + R"(,[600030,5300000],[600030,5300060],[600000,5300060],[600000,5300000]]]}}]})");
    const VolumesFound v = volumes_of({folder / "a.tif", {}, 100.0, folder / "half.geojson", 0.0});
    EXPECT_NEAR(number(v, "area"), 1800.0, 1e-6) << wild;
    EXPECT_EQ(number(v, "polygon_vertices_left_out"), 1.0) << wild;
  }
}

TEST(VolumeFiles, APolygonInAnotherCrsIsBroughtToThatOfTheModel) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 5.0), "EPSG:32632");
  const core::Transform to_degrees(core::Crs("EPSG:32632"), core::Crs("EPSG:4326"));
  std::string ring;
  for (const auto& [x, y] : {std::pair{0, 0}, {30, 0}, {30, 60}, {0, 60}, {0, 0}}) {
    const Eigen::Vector3d p = to_degrees({600000.0 + x, 5300000.0 + y, 0.0});
    char text[80];
    std::snprintf(text, sizeof text, "%s[%.11f,%.11f]", ring.empty() ? "" : ",", p.x(), p.y());
    ring += text;
  }
  test::write_bytes(
      folder / "half.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[)" + ring +
          "]]}}]}");
  const VolumesFound v = volumes_of({folder / "a.tif", {}, 100.0, folder / "half.geojson", 0.0});
  EXPECT_NEAR(number(v, "area"), 1800.0, 1e-3);
  EXPECT_NEAR(number(v, "cut"), 0.5 * cone, tolerance * cone);
}

TEST(VolumeFiles, OfAModelOfAnySizeOnlyThePolygonsPartIsHeld) {
  // Two tiles 100 km apart: 1e10 cells.
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 5.0), "EPSG:32632");
  write(folder.path(), "b", heap({1.0, 700000, 5400000, 60, 60}, 5.0), "EPSG:32632");
  io::write_vrt(folder / "all.vrt", {folder / "a.tif", folder / "b.tif"});
  test::write_bytes(folder / "heap.geojson",
                    R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[{"type":"Feature",
"properties":{},"geometry":{"type":"Polygon","coordinates":[[[700000,5400000],[700060,5400000],[700060,5400060],[700000,5400060],
[700000,5400000]]]}}]})");
  EXPECT_NEAR(number(volumes_of({folder / "all.vrt", {}, 100.0, folder / "heap.geojson", 0.0}), "cut"), cone, tolerance * cone);
}

TEST(VolumeFiles, FeetBecomeCubicMetres) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 300000, 60, 60}, 0.0), "EPSG:2263+6360");
  write(folder.path(), "b", heap({1.0, 600000, 300000, 60, 60}, 5.0), "EPSG:2263+6360");
  const VolumesFound v = volumes_of({folder / "a.tif", folder / "b.tif", {}, {}, 1.0});
  const double foot = 1200.0 / 3937.0;
  EXPECT_NEAR(number(v, "fill"), cone * foot * foot * foot, tolerance * cone * foot * foot * foot);
}

TEST(VolumeFiles, TheBandsOwnUnitCountsWhereTheCrsHasNoVerticalPart) {
  const test::TemporaryFolder folder;
  // Feet across; heights in the unit that the band states.
  const auto heap_in = [&](const std::string& name, double height, const char* unit) {
    const core::Grid g = heap({1.0, 600000, 300000, 60, 60}, height);
    io::write_raster(folder / name, g.lattice, {{"height", unit, &g.height}}, "EPSG:2263", true);
  };
  heap_in("a.tif", 0.0, "ft");
  heap_in("b.tif", 5.0, "ft");
  heap_in("c.tif", 5.0, "m");
  const double foot = 1200.0 / 3937.0;
  EXPECT_NEAR(number(volumes_of({folder / "a.tif", folder / "b.tif", {}, {}, 1.0}), "fill"), cone * foot * foot * 0.3048,
              tolerance * cone * foot * foot * 0.3048);
  EXPECT_THROW(volumes_of({folder / "a.tif", folder / "c.tif", {}, {}, 1.0}), core::Error);
}

TEST(VolumeFiles, UndeclaredValuesForNoneAreVoidAndNamed) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 60, 60}, 0.0), "EPSG:32632");
  // Ten columns of -9999 without a declared value, at the size of cells of the first surface and at half of it.
  for (const int per : {1, 2}) {
    std::string text = "ncols " + std::to_string(60 * per) + "\nnrows " + std::to_string(60 * per) +
                       "\nxllcorner 600000\nyllcorner 5300000\ncellsize " + (per == 1 ? "1" : "0.5") + "\n";
    const core::Grid g = heap({1.0 / per, 600000 * per, 5300000 * per, 60 * per, 60 * per}, 5.0);
    for (int j = 60 * per - 1; j >= 0; --j, text += "\n")
      for (int i = 0; i < 60 * per; ++i) text += (i < 10 * per ? "-9999" : std::to_string(g.height[g.lattice.at(i, j)])) + " ";
    test::write_bytes(folder / "b.asc", text);
    const VolumesFound v = volumes_of({folder / "a.tif", folder / "b.asc", {}, {}, 1.0});
    EXPECT_NEAR(number(v, "fill"), cone, tolerance * cone);
    EXPECT_EQ(number(v, "cut"), 0.0);
    EXPECT_EQ(number(v, "impossible_heights"), 600.0 * per * per);
    EXPECT_NE(volume_text(v).find("heights of -9999, which no ground has, are taken as void"), std::string::npos) << volume_text(v);
    EXPECT_NE(volume_text(v).find("declare the value: NODATA_value -9999 in its header"), std::string::npos);
    EXPECT_NE(volume_text(v).find("b.asc states no CRS: taken to be in that of a.tif, WGS 84 / UTM zone 32N"), std::string::npos);
  }
}

TEST(VolumeFiles, WhatDoesNotFitIsAnError) {
  const test::TemporaryFolder folder;
  write(folder.path(), "a", heap({1.0, 600000, 5300000, 20, 20}, 0.0), "EPSG:32632");
  write(folder.path(), "b", heap({1.0, 600000, 5300000, 20, 20}, 0.0), "EPSG:32633");
  write(folder.path(), "c", heap({1.0, 600500, 5300000, 20, 20}, 0.0), "EPSG:32632");
  EXPECT_THROW(volumes_of({folder / "a.tif", folder / "b.tif", {}, {}, 1.0}), core::Error);
  EXPECT_THROW(volumes_of({folder / "a.tif", folder / "c.tif", {}, {}, 1.0}), core::Error);
  EXPECT_THROW(volumes_of({folder / "none.tif", {}, 1.0, {}, 1.0}), core::Error);
}

}  // namespace
}  // namespace swath::pipeline
