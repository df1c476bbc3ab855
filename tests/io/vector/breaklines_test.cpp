// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/breaklines.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/survey/survey.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::BreaklineKind;

constexpr const char* utm = "EPSG:32632";
constexpr double exact = 1e-9;      // m: what a file of doubles keeps of a coordinate of 5e6
constexpr double projected = 1e-4;  // m: PROJ there and back

struct Shape {
  const char* wkt;
  double z = 0;  ///< attribute; 0: none
};

void make(const std::filesystem::path& file, const char* driver, const std::string& crs, const std::vector<Shape>& shapes,
          const char* layer_name = "edges") {
  const GdalMessages registered;
  const bool dxf = std::string(driver) == "DXF";
  GDALDataset* set = GetGDALDriverManager()->GetDriverByName(driver)->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  ASSERT_NE(set, nullptr);
  OGRSpatialReference srs;
  if (!crs.empty()) srs.SetFromUserInput(crs.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRLayer* layer = set->CreateLayer(layer_name, crs.empty() ? nullptr : &srs, wkbUnknown, nullptr);
  OGRFieldDefn z("z", OFTReal);
  if (!dxf) {
    ASSERT_EQ(layer->CreateField(&z), OGRERR_NONE);
  }
  for (const Shape& s : shapes) {
    OGRFeature feature(layer->GetLayerDefn());
    if (s.z != 0) feature.SetField("z", s.z);
    if (dxf) feature.SetField("Layer", layer_name);
    OGRGeometry* shape = nullptr;
    ASSERT_EQ(OGRGeometryFactory::createFromWkt(s.wkt, nullptr, &shape), OGRERR_NONE);
    feature.SetGeometryDirectly(shape);
    ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  }
  GDALClose(set);
}

class Breaklines : public ::testing::Test {
 protected:
  Breaklines() {
    survey_.folder = folder_.path();
    survey_.crs = utm;
  }
  BreaklineFile& add(const std::string& name, BreaklineKind kind) {
    survey_.breaklines.emplace_back();
    survey_.breaklines.back().file = name;
    survey_.breaklines.back().kind = kind;
    return survey_.breaklines.back();
  }
  std::vector<core::Breakline> read() { return read_breaklines(survey_, survey_.crs, tally_); }
  std::string fault() {
    try {
      read();
    } catch (const core::Error& e) {
      return e.where().substr(e.where().rfind('/') + 1) + ": " + e.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

constexpr const char* edge = "LINESTRING Z (500000 5300000 400,500010 5300005 401.5)";
constexpr const char* pond =
    "POLYGON ((500000 5300000,500010 5300000,500010 5300010,500000 5300000),(500006 5300002,500008 5300002,500008 5300004,500006 5300002))";

TEST_F(Breaklines, GeoPackageLinesAndAreas) {
  make(folder_ / "a.gpkg", "GPKG", utm,
       {{edge}, {"MULTILINESTRING Z ((500000 5300020 1,500001 5300020 2),(500005 5300020 3,500006 5300020 4))"}});
  make(folder_ / "b.gpkg", "GPKG", utm, {{pond}, {pond, 395.25}});
  add("a.gpkg", BreaklineKind::breakline).sigma = core::Metres(0.02);
  add("b.gpkg", BreaklineKind::lake);
  const auto lines = read();
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0].parts.front().size(), 2u);
  EXPECT_NEAR(lines[0].parts.front()[1].y(), 5300005.0, exact);
  EXPECT_NEAR(lines[0].parts.front()[1].z(), 401.5, exact);
  EXPECT_EQ(lines[0].sigma, 0.02);
  EXPECT_TRUE(lines[0].place.ends_with("a.gpkg: layer edges, feature 1"));
  EXPECT_EQ(lines[2].parts.front()[1].z(), 4.0);
  EXPECT_EQ(lines[3].kind, BreaklineKind::lake);
  EXPECT_FALSE(lines[3].has_height);
  ASSERT_EQ(lines[3].parts.size(), 2u);
  EXPECT_EQ(lines[3].parts[0].size(), 3u);
  EXPECT_TRUE(lines[4].has_height);
  EXPECT_EQ(lines[4].parts[1][0].z(), 395.25);
}

TEST_F(Breaklines, ShapefileAndDxf) {
  make(folder_ / "s.shp", "ESRI Shapefile", utm, {{edge}});
  make(folder_ / "d.dxf", "DXF", "", {{edge}}, "KERB");
  add("s.shp", BreaklineKind::breakline);
  add("d.dxf", BreaklineKind::breakline).layer = "KERB";
  const auto lines = read();
  ASSERT_EQ(lines.size(), 2u);
  for (const auto& l : lines) {
    ASSERT_EQ(l.parts.front().size(), 2u);
    EXPECT_NEAR((l.parts.front()[1] - Eigen::Vector3d(500010, 5300005, 401.5)).norm(), 0.0, 1e-6);
  }
  survey_.breaklines[1].layer = "GUTTER";
  EXPECT_EQ(fault(), "d.dxf: no lines of layer 'GUTTER'");
}

TEST_F(Breaklines, OtherCrsIsTransformed) {
  make(folder_ / "a.gpkg", "GPKG", "EPSG:32633", {{edge}});
  add("a.gpkg", BreaklineKind::breakline);
  const Eigen::Vector3d expected = core::Transform(core::Crs("EPSG:32633"), core::Crs(utm))({500010, 5300005, 401.5});
  EXPECT_LT((read()[0].parts.front()[1] - expected).norm(), projected);
}

TEST_F(Breaklines, HeightsCountInTheUnitsOfTheMaps) {
  constexpr double foot = 1200.0 / 3937.0;
  const std::string in_feet = "+proj=utm +zone=32 +datum=WGS84 +units=us-ft";
  make(folder_ / "metres.gpkg", "GPKG", utm, {{edge}});
  add("metres.gpkg", BreaklineKind::breakline);
  survey_.points.emplace_back().file = "a.laz";
  survey_.crs = in_feet;
  Eigen::Vector3d at = read()[0].parts.front()[1];
  EXPECT_NEAR(at.x() * foot, 500010.0, projected);
  EXPECT_NEAR(at.z() * foot, 401.5, exact) << "heights of the cloud are in feet";
  // A drawing in feet to a map in metres.
  make(folder_ / "feet.dxf", "DXF", "", {{"LINESTRING Z (1640416.6667 17388416.6667 400,1640449.475 17388433.0708 401.5)"}});
  survey_.breaklines.clear();
  add("feet.dxf", BreaklineKind::breakline).crs = in_feet;
  survey_.crs = utm;
  at = read()[0].parts.front()[1];
  EXPECT_NEAR(at.x(), 500010.0, 1e-3);
  EXPECT_NEAR(at.z(), 401.5 * foot, exact);
  // Without clouds, and where the survey says so, heights are in another unit than the map.
  survey_.points.clear();
  EXPECT_NEAR(read()[0].parts.front()[1].z(), 401.5, exact);
  survey_.height_unit = core::Metres(0.3048);
  EXPECT_NEAR(read()[0].parts.front()[1].z(), 401.5, exact) << "feet to feet";
}

TEST_F(Breaklines, WhatDoesNotSuitIsNamed) {
  const auto refused = [&](const char* wkt, BreaklineKind kind) {
    std::filesystem::remove(folder_ / "a.gpkg");
    make(folder_ / "a.gpkg", "GPKG", utm, {{wkt}});
    survey_.breaklines.clear();
    add("a.gpkg", kind);
    return fault();
  };
  const std::string first = "a.gpkg: layer edges, feature 1: ";
  EXPECT_EQ(refused("LINESTRING (0 0,1 1)", BreaklineKind::breakline), first + "the breakline has no heights");
  EXPECT_EQ(refused("LINESTRING Z (0 0 1,1 1 1,2 0 1)", BreaklineKind::lake), first + "the line is not closed, while an area is needed");
  EXPECT_EQ(refused("POINT Z (0 0 1)", BreaklineKind::breakline), first + "the feature is a POINT, not a line or an area");
}

TEST_F(Breaklines, HeightsAsTextAreNumbersOrAnError) {
  const auto with = [&](const std::string& z) {
    test::write_bytes(folder_ / "a.geojson",
                      R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"z": )" + z +
                          R"(}, "geometry": {"type": "LineString", "coordinates": [[9, 47.85], [9.001, 47.85]]}}]})");
    return fault();
  };
  add("a.geojson", BreaklineKind::breakline);
  EXPECT_EQ(with("\"401.5\""), "no error");
  EXPECT_EQ(read()[0].parts.front()[1].z(), 401.5);
  EXPECT_NE(with("\"401,5\"").find("attribute 'z' is '401,5', which is not a number"), std::string::npos);
  EXPECT_NE(with("\"\"").find("the breakline has no heights"), std::string::npos);
}

TEST_F(Breaklines, HeightsOfAnUnknownDatumAreNotGuessedAt) {
  survey_.crs = "EPSG:25832+5783";
  make(folder_ / "a.gpkg", "GPKG", "EPSG:25832", {{edge}});
  add("a.gpkg", BreaklineKind::breakline);
  EXPECT_NE(fault().find("does not say what its heights are"), std::string::npos);
  survey_.breaklines[0].crs = survey_.crs;
  EXPECT_NEAR(read()[0].parts.front()[1].z(), 401.5, exact);
}

}  // namespace
}  // namespace swath::io
