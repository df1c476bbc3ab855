// SPDX-License-Identifier: GPL-3.0-or-later
// CRSs and units of clouds, what is refused in the plan, and products that outlive a failure.
#include <cmath>
#include <set>

#include "core/geo/crs.h"
#include "tests/pipeline/cloud_case.h"

namespace swath::pipeline {
namespace {

/// What make_plan or the run refuses, as text; empty where it does not.
std::string refusal(CloudCase& c, const std::string& stages = copy_stages) {
  try {
    c.run(stages, "500 m");
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(Cloud, HeightsOfAnUnknownSystemAreNotShifted) {
  // WGS 84 heights over EGM96 were asked for, and the file does not say what its heights are.
  CloudCase c;
  c.survey = "crs = \"EPSG:32632+5773\"\n";
  c.add(square(100, easting, northing, 100, 300), "open.las", "EPSG:32632");
  const std::string text = refusal(c);
  EXPECT_NE(text.find("does not state its height system"), std::string::npos) << text;
  EXPECT_NE(text.find("open.las"), std::string::npos) << text;
  EXPECT_NE(text.find("points.crs"), std::string::npos) << text;
  EXPECT_FALSE(fs::exists(c.folder / "out 500 m"));

  CloudCase same;  // stated: nothing is to be done
  same.survey = "crs = \"EPSG:32632+5773\"\n";
  same.add(square(100, easting, northing, 100, 300), "level.las", "EPSG:32632+5773");
  const fs::path out = same.run(copy_stages, "500 m");
  for (const double z : points_of(out).z) EXPECT_EQ(z, 300.0);
  EXPECT_EQ(report_of(out).find("crs")->find("heights")->as_text(), core::Crs("EPSG:32632+5773").vertical_name());

  CloudCase back;  // the other way round
  back.add(square(100, easting, northing, 100, 300), "level.las", "EPSG:32632+5773");
  EXPECT_NE(refusal(back).find("crs = \"EPSG:32632+5773\""), std::string::npos);
}

TEST(Cloud, TheReportSaysWhatHeightsCountFrom) {
  CloudCase open;
  open.add(square(100, easting, northing, 100, 300), "open.las", "EPSG:32632");
  EXPECT_EQ(report_of(open.run(copy_stages, "500 m")).find("crs")->find("heights")->as_text(), "height system not stated");
  CloudCase ellipsoidal;
  ellipsoidal.add(square(100, easting, northing, 100, 300), "e.las", "EPSG:32632+ellipsoidal");
  const fs::path out = ellipsoidal.run(copy_stages, "500 m");
  EXPECT_EQ(report_of(out).find("crs")->find("heights")->as_text(), "ellipsoidal height");
  for (const double z : points_of(out).z) EXPECT_NEAR(z, 300.0, 0.001);
  ellipsoidal.add(square(100, easting, northing, 100, 300), "open.las", "EPSG:32632");
  EXPECT_NE(refusal(ellipsoidal).find("does not state its height system"), std::string::npos);
}

TEST(Cloud, AGeoidThatIsNotInstalledIsMissedInThePlan) {
  CloudCase c;
  c.survey = "crs = \"EPSG:25832+7837\"\n";
  c.add(square(100, easting, northing, 100, 300), "e.las", "EPSG:25832+ellipsoidal");
  const std::string text = refusal(c);
  if (text.empty()) GTEST_SKIP() << "the grid is installed";
  EXPECT_NE(text.find("needs the grid file"), std::string::npos) << text;
}

TEST(Cloud, AFileWithoutACrsIsRefusedInThePlan) {
  CloudCase c;
  c.add(square(100, easting, northing, 100, 300), "none.las", "EPSG:32632");
  c.survey = "[[points]]\nfile = \"none.las\"\n";
  const std::string text = refusal(c);
  EXPECT_NE(text.find("states no CRS"), std::string::npos) << text;
  EXPECT_NE(text.find("points.crs"), std::string::npos) << text;
}

const std::string contour_stages =
    "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"terrain.contours\"\n";

Block hills(double x0, double y0, double side, double height) {
  Block b = square(4000, x0, y0, side, 0);
  for (size_t i = 0; i < b.size(); ++i) b.z[i] = height * (10 + std::sin(b.x[i] / side * 6) + b.y[i] / side);
  b.classification.assign(b.size(), core::point_class::ground);
  return b;
}

TEST(Cloud, GeoJsonIsLeftOutWhereThereIsNoWayToWgs84) {
  CloudCase c;
  const std::string datumless = "+proj=utm +zone=32 +ellps=GRS67 +units=m +no_defs";
  c.survey = "crs = \"" + datumless + "\"\n";
  c.add(hills(easting, northing, 100, 10), "hills.las", datumless);
  const fs::path out = c.run(contour_stages, "500 m");
  EXPECT_TRUE(fs::exists(out / "contours.gpkg") && fs::exists(out / "contours.dxf"));
  EXPECT_FALSE(fs::exists(out / "contours.geojson"));
  const std::string report = test::read_bytes(out / "report.json");
  EXPECT_NE(report.find("contours.geojson is left out"), std::string::npos);
}

TEST(Cloud, AFootCrsNamesTilesAndSpacesContoursInFeet) {
  CloudCase c;
  c.survey = "crs = \"EPSG:2992\"\n";
  c.add(hills(640000, 850000, 1500, 30), "feet.las", "EPSG:2992");
  test::write_bytes(c.folder / "p.toml", contour_stages + "[[stage]]\ntype = \"writers.las\"\n");
  test::write_bytes(c.folder / "survey.toml", c.survey);
  Request r;
  r.config = c.folder / "p.toml", r.survey = c.folder / "survey.toml", r.output = c.folder / "out", r.threads = 2;
  Plan plan = make_plan(r);
  EXPECT_NEAR(plan.run.tile.value, 1600 * 0.3048, 1e-9);
  Progress progress(Voice::quiet);
  pipeline::run(plan, progress, "test");
  EXPECT_TRUE(fs::exists(r.output / "points/640000_849600.laz"));
  const std::string text = test::read_bytes(r.output / "contours.geojson");
  std::set<long> levels;
  for (size_t at = text.find("\"height\": "); at != std::string::npos; at = text.find("\"height\": ", at + 1)) {
    const double level = std::stod(text.substr(at + 10));
    EXPECT_EQ(level, std::round(level));
    levels.insert(std::lround(level));
  }
  ASSERT_GT(levels.size(), 5u);
  EXPECT_EQ(*std::next(levels.begin()) - *levels.begin(), 2);  // 2 ft
}

TEST(Cloud, ProductsThatAreFinishedOutliveALateFailure) {
  CloudCase c;
  c.add(hills(easting, northing, 100, 10), "hills.las", "EPSG:32632");
  const std::string stages = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"writers.gdal\"\n";
  const std::string text = refusal(c, stages + "[[stage]]\ntype = \"writers.picture\"\ncontours = \"dtm.vrt\"\n");
  EXPECT_NE(text.find("the same command goes on from there"), std::string::npos) << text;
  EXPECT_TRUE(fs::exists(c.folder / "out 500 m/dtm.vrt"));
  EXPECT_EQ(refusal(c, stages + "[[stage]]\ntype = \"writers.picture\"\n"), "");
  EXPECT_TRUE(fs::exists(c.folder / "out 500 m/relief.png"));
}

}  // namespace
}  // namespace swath::pipeline
