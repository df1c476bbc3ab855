// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/line_file.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

/// GeoJSON of one line, which is in degrees of WGS 84 where it names no CRS.
std::string geojson(const std::vector<Eigen::Vector2d>& places, const std::string& crs) {
  std::string out = R"({"type":"FeatureCollection",)";
  if (!crs.empty()) out += R"("crs":{"type":"name","properties":{"name":")" + crs + R"("}},)";
  out += R"("features":[{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[)";
  for (size_t k = 0; k < places.size(); ++k) {
    char text[80];
    std::snprintf(text, sizeof text, "%s[%.10f,%.10f]", k ? "," : "", places[k].x(), places[k].y());
    out += text;
  }
  return out + "]}}]}";
}

TEST(LineFile, RingsAreClosedLines) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "ring.geojson",
                    geojson({{600000, 5300000}, {600060, 5300000}, {600060, 5300050}, {600000, 5300000}}, "EPSG:32632"));
  test::write_bytes(folder / "open.geojson", geojson({{600000, 5300000}, {600060, 5300000}, {600060, 5300050}}, "EPSG:32632"));
  std::uint64_t left_out = 0;
  const auto rings = read_rings_in(folder / "ring.geojson", core::Crs("EPSG:32632"), left_out);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].size(), 3u);
  EXPECT_EQ(left_out, 0u);
  EXPECT_THROW(read_rings_in(folder / "open.geojson", core::Crs("EPSG:32632"), left_out), core::Error);
}

TEST(LineFile, LinesComeInTheCrsOfTheData) {
  const test::TemporaryFolder folder;
  const std::vector<Eigen::Vector2d> map{{600000, 5300000}, {600060, 5300020}, {600030, 5300055}};
  std::vector<Eigen::Vector2d> degrees;
  const core::Transform to_degrees(core::Crs("EPSG:32632"), core::Crs("EPSG:4326"));
  for (const auto& p : map) degrees.push_back(to_degrees({p.x(), p.y(), 0.0}).head<2>());
  test::write_bytes(folder / "degrees.geojson", geojson(degrees, ""));
  test::write_bytes(folder / "map.geojson", geojson(map, "EPSG:32632"));
  // Heights of the data ask for no geoid.
  for (const char* crs : {"EPSG:32632", "EPSG:32632+5773"})
    for (const char* name : {"degrees.geojson", "map.geojson"}) {
      const auto lines = read_lines_in(folder / name, core::Crs(crs));
      ASSERT_EQ(lines.size(), 1u);
      for (size_t k = 0; k < map.size(); ++k) {
        EXPECT_NEAR(lines[0].x[k], map[k].x(), 1e-4) << name << crs;
        EXPECT_NEAR(lines[0].y[k], map[k].y(), 1e-4) << name << crs;
      }
    }
  EXPECT_EQ(read_lines_in(folder / "map.geojson", core::Crs()).front().x[0], 600000.0);
}

TEST(LineFile, CoordinatesThatAreNotOfTheStatedCrsAreAnError) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "map.geojson", geojson({{600000, 5300000}, {600060, 5300020}}, ""));
  try {
    read_lines_in(folder / "map.geojson", core::Crs("EPSG:32632"));
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("WGS 84"), std::string::npos) << e.text();
    EXPECT_NE(e.text().find("UTM zone 32N"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::pipeline
