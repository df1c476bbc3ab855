// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/describe_vector.h"

#include "io/vector/vector.h"
#include "tests/io/vector/write_contours.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

core::ContourLine line(double height) {
  core::ContourLine l;
  l.x = {500000, 500010, 500020};
  l.y = {5300000, 5300005, 5300000};
  l.height = height;
  return l;
}

TEST(DescribeVector, ContoursOfThisProgram) {
  const test::TemporaryFolder folder;
  write_contours({folder / "a.gpkg", folder / "a.dxf", folder / "a.geojson"}, {line(410), line(412)}, "EPSG:32632");
  const core::Value gpkg = describe_vector(folder / "a.gpkg");
  EXPECT_EQ(gpkg.find("format")->as_text(), "GeoPackage");
  const core::Value& lines = gpkg.find("layers")->items()[0];
  EXPECT_EQ(lines.find("name")->as_text(), "contours");
  EXPECT_EQ(lines.find("heights")->as_text(), "height system not stated");
  EXPECT_EQ(lines.find("features")->as_int(), 2);
  EXPECT_EQ(lines.find("height")->items()[1].as_number(), 412);
  EXPECT_EQ(lines.find("x")->items()[1].as_number(), 500020);
  EXPECT_EQ(lines.find("epsg")->as_int(), 32632);
  EXPECT_NE(lines.find("description")->as_text().find("height system not stated"), std::string::npos);
  const core::Value dxf = describe_vector(folder / "a.dxf");
  EXPECT_EQ(dxf.find("format")->as_text(), "DXF");
  EXPECT_NE(dxf.find("comments")->items()[1].as_text().find("height system not stated"), std::string::npos);
  EXPECT_EQ(describe_vector(folder / "a.geojson").find("layers")->items()[0].find("features")->as_int(), 2);
}

TEST(DescribeVector, HeightsOfFlatLinesAreThoseOfTheDescription) {
  const test::TemporaryFolder folder;
  ContourWriter writer(folder / "a.gpkg", "EPSG:32632", "ellipsoidal height");
  writer.add(line(410));
  writer.close();
  EXPECT_EQ(describe_vector(folder / "a.gpkg").find("layers")->items()[0].find("heights")->as_text(), "ellipsoidal height");
}

TEST(DescribeVector, TextAndNonsenseAreNone) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", "x,y\n1,2\n");
  test::write_bytes(folder / "a.bin", std::string(100, 'x'));
  EXPECT_TRUE(describe_vector(folder / "a.csv").is_null());
  EXPECT_TRUE(describe_vector(folder / "a.bin").is_null());
}

}  // namespace
}  // namespace swath::io
