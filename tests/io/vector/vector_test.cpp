// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/vector.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "core/error.h"
#include "io/vector/gdal_door.h"
#include "tests/io/file_size_limit.h"
#include "tests/io/vector/write_contours.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// DXF holds 4 decimals of a metre.
constexpr double dxf_tolerance = 0.5001e-4;
/// 9 decimals of a degree are 0.11 mm on the ground; the way back adds PROJ's own closure (below 1e-6 m).
constexpr double geojson_tolerance = 1e-4;

std::vector<core::ContourLine> made_lines(int n = 6) {
  std::vector<core::ContourLine> lines;
  for (int c = 0; c < n; ++c) {
    core::ContourLine line;
    line.height = 420.0 + 0.5 * c;
    line.index = c % 5 == 0;
    line.closed = c % 2 == 0;
    for (int k = 0; k <= 24; ++k) {
      const double a = (line.closed ? 2.0 : 1.0) * M_PI * (k % 24) / 24.0 + (k == 24 && !line.closed ? M_PI : 0.0);
      line.x.push_back(500123.25 + (10.0 + c) * std::cos(a));
      line.y.push_back(5300456.75 + (10.0 + c) * std::sin(a));
    }
    lines.push_back(line);
  }
  return lines;
}

void expect_same(const std::vector<VectorLine>& got, const std::vector<core::ContourLine>& want, double tolerance) {
  ASSERT_EQ(got.size(), want.size());
  for (size_t c = 0; c < want.size(); ++c) {
    EXPECT_EQ(got[c].height, want[c].height);
    EXPECT_EQ(got[c].index, want[c].index) << c;
    EXPECT_EQ(got[c].closed, want[c].closed) << c;
    ASSERT_EQ(got[c].x.size(), want[c].x.size());
    for (size_t k = 0; k < want[c].x.size(); ++k) {
      ASSERT_NEAR(got[c].x[k], want[c].x[k], tolerance);
      ASSERT_NEAR(got[c].y[k], want[c].y[k], tolerance);
    }
  }
}

TEST(Vector, GeoPackageReturnsEveryBit) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.gpkg"}, made_lines(), "EPSG:25832+7837");
  EXPECT_EQ(test::entries(folder.path()), 1u);
  const VectorLines got = read_lines(folder / "a.gpkg");
  expect_same(got.lines, made_lines(), 0.0);
  EXPECT_NE(got.crs_wkt.find("25832"), std::string::npos);

  const GdalMessages registered;
  auto* d = GDALDataset::Open((folder / "a.gpkg").c_str(), GDAL_OF_VECTOR);
  ASSERT_NE(d, nullptr);
  OGRLayer* layer = d->GetLayerByName("contours");
  ASSERT_NE(layer, nullptr);
  EXPECT_EQ(layer->GetGeomType(), wkbLineString);
  EXPECT_EQ(layer->GetLayerDefn()->GetFieldDefn(0)->GetType(), OFTReal);
  EXPECT_EQ(layer->GetLayerDefn()->GetFieldDefn(1)->GetSubType(), OFSTBoolean);
  EXPECT_EQ(layer->GetLayerDefn()->GetFieldDefn(2)->GetSubType(), OFSTBoolean);
  EXPECT_NE(std::string(layer->GetMetadataItem("DESCRIPTION")).find("Deutsches Haupthoehennetz 2016"), std::string::npos);
  EXPECT_TRUE(layer->TestCapability(OLCFastSpatialFilter));
  GDALClose(d);
}

TEST(Vector, DxfHasElevationsLayersAndExtent) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.dxf"}, made_lines(), "EPSG:32632");
  const VectorLines got = read_lines(folder / "a.dxf");
  expect_same(got.lines, made_lines(), dxf_tolerance);
  for (const VectorLine& line : got.lines) {
    EXPECT_EQ(line.layer, line.index ? "CONTOUR_INDEX" : "CONTOUR");
    for (const double z : line.z) EXPECT_EQ(z, line.height);
  }
  const std::string text = test::read_bytes(folder / "a.dxf");
  const auto at = text.find("$EXTMIN\n10\n");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(text.substr(at + 11)), 500123.25 - 15.0, dxf_tolerance);  // the widest line has a radius of 15 m
  EXPECT_EQ(text.substr(text.size() - 6), "0\nEOF\n");
  EXPECT_NE(text.find("height system not stated"), std::string::npos);
}

TEST(Vector, GeoJsonIsInWgs84) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.geojson"}, made_lines(), "EPSG:25832+7837");
  VectorLines got = read_lines(folder / "a.geojson");
  ASSERT_EQ(got.lines.size(), made_lines().size());
  const GdalMessages registered;
  OGRSpatialReference wgs84, utm;
  wgs84.SetFromUserInput("EPSG:4326");
  utm.SetFromUserInput("EPSG:25832");
  for (auto* s : {&wgs84, &utm}) s->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> back(OGRCreateCoordinateTransformation(&wgs84, &utm));
  for (VectorLine& line : got.lines) {
    EXPECT_NEAR(line.x[0], 9.0, 0.01);  // the central meridian of zone 32
    EXPECT_NEAR(line.y[0], 47.85, 0.05);
    ASSERT_TRUE(back->Transform(static_cast<int>(line.x.size()), line.x.data(), line.y.data()));
  }
  expect_same(got.lines, made_lines(), geojson_tolerance);
  const std::string text = test::read_bytes(folder / "a.geojson");
  EXPECT_NE(text.find("\"height_reference\": \"Deutsches Haupthoehennetz 2016\""), std::string::npos);
  EXPECT_EQ(text.find("\"crs\""), std::string::npos);  // RFC 7946 has no such member
}

TEST(Vector, GeoJsonIsCutAtTheAntimeridian) {
  const test::TemporaryFolder folder;
  core::ContourLine line;
  line.x = {160000.0, 172000.0};  // zone 1: central meridian 177 W; 180 lies 334 km to the west, at 166 km, on the equator
  line.y = {100.0, 100.0};
  line.height = 5.0;
  write_contours({folder / "a.geojson"}, {line}, "EPSG:32601");
  const VectorLines got = read_lines(folder / "a.geojson");
  ASSERT_EQ(got.lines.size(), 2u);
  EXPECT_EQ(got.lines[0].x.back(), 180.0);
  EXPECT_EQ(got.lines[1].x.front(), -180.0);
  EXPECT_EQ(got.lines[0].y.back(), got.lines[1].y.front());
  for (const VectorLine& part : got.lines) EXPECT_EQ(part.height, 5.0);
}

TEST(Vector, FeetAreNamedAndKept) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.gpkg", folder / "a.dxf", folder / "a.geojson"}, made_lines(), "EPSG:2263+6360");
  EXPECT_EQ(read_lines(folder / "a.geojson").lines[1].height, 420.5);
  EXPECT_NE(test::read_bytes(folder / "a.geojson").find("\"height_unit\": \"ftUS\""), std::string::npos);
  EXPECT_NE(test::read_bytes(folder / "a.dxf").find("elevations in ftUS"), std::string::npos);
  EXPECT_NE(read_lines(folder / "a.gpkg").crs_wkt.find("US survey foot"), std::string::npos);
}

TEST(Vector, ARingWithoutItsLastVertexIsClosedAndADxfFlagSaysSo) {
  const test::TemporaryFolder folder;
  core::ContourLine ring;
  ring.x = {0, 10, 10};
  ring.y = {0, 0, 10};
  ring.closed = true;
  write_contours({folder / "a.gpkg", folder / "a.dxf"}, {ring}, "");
  for (const char* name : {"a.gpkg", "a.dxf"}) {
    const VectorLines got = read_lines(folder / name);
    ASSERT_EQ(got.lines.size(), 1u);
    EXPECT_EQ(got.lines[0].x, (std::vector<double>{0, 10, 10, 0})) << name;
    EXPECT_TRUE(got.lines[0].closed);
  }
  EXPECT_NE(test::read_bytes(folder / "a.dxf").find("\n70\n1\n0\nVERTEX"), std::string::npos);
}

TEST(Vector, EqualContoursAreEqualBytes) {
  const test::TemporaryFolder folder;
  for (const char* ending : {".gpkg", ".dxf", ".geojson"}) {
    write_contours({folder / (std::string("a") + ending)}, made_lines(40), "EPSG:32632");
    write_contours({folder / (std::string("b") + ending)}, made_lines(40), "EPSG:32632");
    EXPECT_EQ(test::read_bytes(folder / (std::string("a") + ending)), test::read_bytes(folder / (std::string("b") + ending))) << ending;
  }
  EXPECT_NE(test::read_bytes(folder / "a.gpkg").find("2000-01-01T00:00:00.000Z"), std::string::npos);
}

TEST(Vector, DepressionsLabelsAndSpotHeights) {
  const test::TemporaryFolder folder;
  std::vector<core::ContourLine> lines = made_lines();
  lines[2].depression = true;
  for (const char* name : {"a.gpkg", "a.dxf", "a.geojson"}) {
    ContourWriter w(folder / name, "EPSG:25832+7837");
    for (const auto& line : lines) w.add(line);
    w.add(core::ContourLabel{500130.0, 5300460.0, "420", 0.5, 2.0, 420.0});
    w.add(core::SpotHeight{500140.0, 5300470.0, 431.25, "431.3", false, 2.0});
    EXPECT_THROW(w.add(core::SpotHeight{500140.0, std::nan(""), 431.25, "431.3", false, 2.0}), core::Error);
    EXPECT_EQ(w.count(), lines.size());
    w.close();
    const VectorLines got = read_lines(folder / name);
    ASSERT_EQ(got.lines.size(), lines.size()) << name;
    for (size_t k = 0; k < lines.size(); ++k) EXPECT_EQ(got.lines[k].depression, lines[k].depression) << name << " " << k;
  }
  const GdalMessages registered;
  auto* d = GDALDataset::Open((folder / "a.gpkg").c_str(), GDAL_OF_VECTOR);
  ASSERT_NE(d, nullptr);
  OGRLayer* labels = d->GetLayerByName("labels");
  OGRLayer* spots = d->GetLayerByName("spot_heights");
  ASSERT_NE(labels, nullptr);
  ASSERT_NE(spots, nullptr);
  const OGRFeatureUniquePtr label(labels->GetNextFeature()), spot(spots->GetNextFeature());
  EXPECT_STREQ(label->GetFieldAsString("text"), "420");
  EXPECT_NEAR(label->GetFieldAsDouble("rotation"), 0.5 * 180.0 / M_PI, 1e-12);
  EXPECT_EQ(label->GetGeometryRef()->toPoint()->getX(), 500130.0);
  EXPECT_STREQ(spot->GetFieldAsString("kind"), "pit");
  EXPECT_EQ(spot->GetFieldAsDouble("height"), 431.25);
  GDALClose(d);
  const std::string dxf = test::read_bytes(folder / "a.dxf");
  EXPECT_NE(dxf.find("0\nTEXT\n8\nCONTOUR_LABEL\n10\n500130.0000\n"), std::string::npos);
  EXPECT_NE(dxf.find("\n1\n420\n50\n28.6479\n72\n1\n"), std::string::npos);
  EXPECT_NE(dxf.find("0\nPOINT\n8\nSPOT_HEIGHT\n10\n500140.0000\n"), std::string::npos);
  EXPECT_NE(test::read_bytes(folder / "a.geojson").find("\"depression\": true"), std::string::npos);
}

TEST(Vector, NoContourAtAllIsAValidFile) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.gpkg", folder / "a.dxf", folder / "a.geojson"}, {}, "EPSG:32632");
  for (const char* name : {"a.gpkg", "a.dxf", "a.geojson"}) EXPECT_TRUE(read_lines(folder / name).lines.empty()) << name;
}

TEST(Vector, AWriterThatIsNotClosedLeavesNothing) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.gpkg", "a.dxf", "a.geojson"}) {
    ContourWriter w(folder / name, "EPSG:32632");
    for (const auto& line : made_lines()) w.add(line);
    EXPECT_EQ(w.count(), 6u);
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

TEST(Vector, AWriteThatIsCutShortAnywhereLeavesNothing) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.gpkg", "a.dxf", "a.geojson"}) {
    write_contours({folder / name}, made_lines(300), "EPSG:32632");
    const auto whole = std::filesystem::file_size(folder / name);
    std::filesystem::remove(folder / name);
    constexpr unsigned steps = 8;
    for (unsigned s = 0; s < steps; ++s) {
      const test::FileSizeLimit limit(s + 1 == steps ? whole - 1 : whole * s / steps);
      EXPECT_THROW(write_contours({folder / name}, made_lines(300), "EPSG:32632"), core::SystemError) << name << s;
      EXPECT_EQ(test::entries(folder.path()), 0u) << name << s;
    }
  }
}

TEST(Vector, BadLinesCrsAndNamesAreErrors) {
  const test::TemporaryFolder folder;
  core::ContourLine line;
  line.x = {1, 2};
  line.y = {1, 2};
  const auto refused = [&](const core::ContourLine& bad) {
    ContourWriter w(folder / "a.dxf", "EPSG:32632");
    EXPECT_THROW(w.add(bad), core::Error);
  };
  core::ContourLine bad = line;
  bad.y.pop_back();
  refused(bad);
  bad.x.pop_back();
  refused(bad);
  bad = line;
  bad.x[1] = std::numeric_limits<double>::quiet_NaN();
  refused(bad);
  bad = line;
  bad.height = std::numeric_limits<double>::infinity();
  refused(bad);
  EXPECT_THROW(ContourWriter(folder / "a.shp", "EPSG:32632"), core::Error);
  EXPECT_THROW(ContourWriter(folder / "a.gpkg", "EPSG:1"), core::Error);
  EXPECT_THROW(ContourWriter(folder / "a.geojson", ""), core::Error);
  EXPECT_THROW(ContourWriter(folder / "a.geojson", "LOCAL_CS[\"site\",UNIT[\"metre\",1]]"), core::Error);
  test::write_bytes(folder / "file", "x");
  for (const char* name : {"file/a.gpkg", "file/a.dxf", "file/a.geojson"})
    EXPECT_THROW(ContourWriter(folder / name, "EPSG:32632"), core::Error);
  EXPECT_THROW(read_lines(folder / "none.gpkg"), core::Error);
  EXPECT_THROW(read_lines(folder / "file"), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 1u);
}

TEST(Vector, ContoursOfGdalAreRead) {
  SWATH_SHARED_OR_SKIP(file, "data/contour_gdal/contour-gdal.geojson");
  const VectorLines got = read_lines(file);
  ASSERT_FALSE(got.lines.empty());
  EXPECT_EQ(got.lines[0].height, 7.5);
  EXPECT_EQ(got.lines[0].x[0], 500120.0);
  for (const VectorLine& line : got.lines) EXPECT_EQ(std::remainder(line.height, 0.5), 0.0);
}

}  // namespace
}  // namespace swath::io
