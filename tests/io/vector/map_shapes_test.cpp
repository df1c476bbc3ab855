// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/map_shapes.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A GeoJSON file with one feature; `crs`: code, empty: as the format says, WGS 84.
std::filesystem::path geojson(const test::TemporaryFolder& folder, const std::string& geometry, const std::string& crs) {
  const auto file = folder / "a.geojson";
  std::ofstream(file) << R"({"type":"FeatureCollection",)"
                      << (crs.empty() ? "" : R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::)" + crs + R"("}},)")
                      << R"("features":[{"type":"Feature","properties":{},"geometry":)" << geometry << "}]}";
  return file;
}

std::string polygon(const std::string& rings) { return R"({"type":"Polygon","coordinates":[)" + rings + "]}"; }

std::string fault(const std::filesystem::path& file, MapShapeKind kind, const std::string& layer = {}) {
  try {
    read_map_shapes(file, layer, core::Crs("EPSG:32632"), kind);
  } catch (const core::Error& e) {
    return std::string(e.what()) + " | " + e.where() + " | " + e.hint();
  }
  return {};
}

TEST(MapShapes, APolygonKeepsItsRings) {
  const test::TemporaryFolder folder;
  const auto file = geojson(folder, polygon("[[0,0],[90,0],[90,90],[0,90],[0,0]],[[10,10],[10,20],[20,20],[10,10]]"), "32632");
  const auto shapes = read_map_shapes(file, "", core::Crs("EPSG:32632"), MapShapeKind::area);
  ASSERT_EQ(shapes.size(), 1u);
  ASSERT_EQ(shapes[0].parts.size(), 2u);
  EXPECT_EQ(shapes[0].parts[0].size(), 4u);
  EXPECT_EQ(shapes[0].parts[1].size(), 3u);
}

TEST(MapShapes, AnotherCrsIsTransformedAndItsSidesStayStraightThere) {
  const test::TemporaryFolder folder;
  const core::Crs map("EPSG:32632");
  const core::Transform to_map(core::Crs("EPSG:4326"), map);
  const auto file = geojson(folder, R"({"type":"LineString","coordinates":[[10,50],[10.2,50]]})", "");
  const auto shapes = read_map_shapes(file, "", map, MapShapeKind::axis);
  ASSERT_EQ(shapes.size(), 1u);
  const auto& line = shapes[0].parts[0];
  EXPECT_GT(line.size(), 140u);  // 14.3 km
  const Eigen::Vector2d middle = to_map({10.1, 50.0, 0.0}).head<2>();
  double nearest = 1e9;
  for (size_t k = 1; k < line.size(); ++k) {
    const Eigen::Vector2d d = line[k] - line[k - 1];
    const double t = std::clamp((middle - line[k - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (line[k - 1] + t * d - middle).norm());
  }
  EXPECT_LT(nearest, 1e-3);  // a chord would miss it by metres
  EXPECT_GT(std::abs((0.5 * (line.front() + line.back()) - middle).y()), 1.0);
}

TEST(MapShapes, WhatIsNoAreaIsAnErrorWithItsFeature) {
  const test::TemporaryFolder folder;
  EXPECT_NE(fault(geojson(folder, polygon("[[0,0],[90,90],[90,0],[0,90],[0,0]]"), "32632"), MapShapeKind::area).find("cross near"),
            std::string::npos);
  EXPECT_NE(fault(geojson(folder, polygon("[[0,0],[90,90],[45,45],[0,0]]"), "32632"), MapShapeKind::area).find("is empty"),
            std::string::npos);
  const std::string few = fault(geojson(folder, polygon("[[0,0],[90,90],[0,0]]"), "32632"), MapShapeKind::area);
  EXPECT_NE(few.find("fewer than three"), std::string::npos);
  EXPECT_NE(few.find("feature 0"), std::string::npos);
  EXPECT_NE(fault(geojson(folder, R"({"type":"Point","coordinates":[1,2]})", "32632"), MapShapeKind::area).find("no area"),
            std::string::npos);
  EXPECT_NE(fault(geojson(folder, polygon("[[0,0],[90,0],[90,90],[0,0]]"), "32632"), MapShapeKind::axis).find("no line"),
            std::string::npos);
  EXPECT_NE(fault(geojson(folder, polygon("[[0,0],[90,0],[90,90],[0,0]]"), "32632"), MapShapeKind::area, "roads").find("'roads'"),
            std::string::npos);
  EXPECT_NE(fault(folder / "none.gpkg", MapShapeKind::area).find("none.gpkg"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
