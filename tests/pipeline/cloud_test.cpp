// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds that enter after georeferencing: units, files that differ, tiles without points.
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/crs.h"
#include "io/las_reader.h"
#include "io/las_writer.h"
#include "io/value_file.h"
#include "pipeline/run.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Block;

constexpr double easting = 500000.0, northing = 5300000.0;

/// A survey with its clouds and a pipeline, run in a folder of its own.
struct CloudCase {
  test::TemporaryFolder folder;
  std::string survey = "crs = \"EPSG:32632\"\n";

  void add(const Block& block, const std::string& name, const std::string& crs, double scale = 0.001, const std::string& more = {}) {
    io::LasWriteOptions o;
    o.scale = Eigen::Vector3d(scale, scale, 0.001);
    o.threads = 1;
    io::LasWriter writer(folder / name, o);
    writer.write(block);
    writer.finish();
    survey += "[[points]]\nfile = \"" + name + "\"\ncrs = \"" + crs + "\"\n" + more;
  }
  /// The products' folder.
  fs::path run(const std::string& stages, const std::string& tile) {
    test::write_bytes(folder / "survey.toml", survey);
    test::write_bytes(folder / "p.toml", stages);
    Request r;
    r.config = folder / "p.toml";
    r.survey = folder / "survey.toml";
    r.output = folder / ("out " + tile);
    r.sets = {"run.tile=\"" + tile + "\""};
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    pipeline::run(plan, progress, "test");
    return r.output;
  }
};

const std::string copy_stages = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"writers.las\"\ncompress = false\n";

/// The points of all tiles, in order of the tiles' names.
Block points_of(const fs::path& out) {
  std::map<std::string, fs::path> files;
  for (const auto& e : fs::directory_iterator(out / "points"))
    if (e.path().extension() == ".las") files[e.path().filename().string()] = e.path();
  Block all;
  for (const auto& [name, file] : files) {
    io::LasReader reader(file, 1);
    Block b;
    while (reader.read(b, 1 << 20) > 0) core::append(all, b);
  }
  return all;
}

Block square(size_t n, double x0, double y0, double side, double z) {
  Block b;
  b.origin = {x0, y0, 0};
  for (size_t i = 0; i < n; ++i) {
    b.x.push_back(side * std::fmod(static_cast<double>(i) * 0.618034, 1.0));
    b.y.push_back(side * std::fmod(static_cast<double>(i) * 0.754878, 1.0));
    b.z.push_back(z);
  }
  return b;
}

TEST(Cloud, HeightsOfAGeographicFileAreMetres) {
  CloudCase c;
  c.add(square(100, 9.0, 47.85, 0.001, 123.4), "degrees.las", "EPSG:4326", 1e-7);
  const Block out = points_of(c.run(copy_stages, "500 m"));
  ASSERT_EQ(out.size(), 100u);
  for (const double z : out.z) EXPECT_NEAR(z, 123.4, 0.001);  // one step of the files
}

TEST(Cloud, AFileStatesTheUnitOfItsHeights) {
  CloudCase c;
  c.add(square(100, easting, northing, 100, 10), "feet.las", "EPSG:32632", 0.001, "height_unit = \"1 ft\"\n");
  for (const double z : points_of(c.run(copy_stages, "500 m")).z) EXPECT_NEAR(z, 3.048, 0.001);
}

TEST(Cloud, ColoursOfOneFileAreNotLostAmongOthers) {
  CloudCase c;
  for (const std::string name : {"a.las", "b.las", "c.las"}) {
    Block b = square(100, easting, northing, 100, 10);
    b.strip.assign(b.size(), static_cast<std::uint16_t>(name[0]));
    if (name == "b.las")
      for (auto* column : {&b.red, &b.green, &b.blue}) column->assign(b.size(), 700);
    c.add(b, name, "EPSG:32632");
  }
  const Block out = points_of(c.run(copy_stages, "500 m"));
  ASSERT_EQ(out.size(), 300u);
  ASSERT_EQ(out.red.size(), 300u);
  for (size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out.red[i], out.strip[i] == 'b' ? 700 : 0) << i;
}

core::Value report_of(const fs::path& out) { return io::read_value_file(out / "report.json"); }

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
  same.survey = c.survey;
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

/// Contours as text and the grid's heights: what tiling must not change.
std::string surface_of(CloudCase& c, const std::string& tile) {
  const fs::path out = c.run(
      "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"terrain.contours\"\n"
      "[[stage]]\ntype = \"writers.gdal\"\n",
      tile);
  const core::Value report = io::read_value_file(out / "report.json");
  const core::Value& dtm = report.find("stages")->items()[1];
  return test::read_bytes(out / "contours.geojson") +
         std::to_string(dtm.find("tally")->find("cells with a height")->find("count")->as_int());
}

TEST(Cloud, TheSurfaceReachesIntoTilesWithoutPoints) {
  // Points around an empty quarter whose corner is that of tiles of 50 m: triangles cut the corner.
  CloudCase c;
  Block b = square(2000, easting, northing, 200, 0);
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < b.size(); ++i) {
    b.z[i] = 100 + 0.1 * b.x[i] + 5 * std::sin(b.y[i] / 20);
    if (b.x[i] < 99 || b.y[i] < 99) rows.push_back(i);
  }
  b = core::select(b, rows);
  b.classification.assign(b.size(), core::point_class::ground);
  c.add(b, "corner.las", "EPSG:32632");
  const std::string whole = surface_of(c, "1000 m");
  EXPECT_EQ(surface_of(c, "50 m"), whole);
  EXPECT_EQ(surface_of(c, "100 m"), whole);
}

TEST(Cloud, KeyPointsAreTheSameForEveryTiling) {
  CloudCase c;
  Block b = square(8000, easting, northing, 200, 0);
  for (size_t i = 0; i < b.size(); ++i) b.z[i] = 100 + 0.1 * b.x[i] + 5 * std::sin(b.y[i] / 20);
  b.classification.assign(b.size(), core::point_class::ground);
  c.add(b, "hills.las", "EPSG:32632");
  const auto key_points = [&](const std::string& tile) {
    const Block out =
        points_of(c.run("[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.key_points\"\n[[stage]]\ntype = "
                        "\"writers.las\"\ncompress = false\n",
                        tile));
    EXPECT_EQ(out.size(), 8000u);
    std::set<std::pair<long, long>> places;  // mm
    for (size_t i = 0; i < out.size(); ++i)
      if (out.flags[i] & core::flag::key_point)
        places.insert({std::lround(1e3 * (out.origin.x() + out.x[i])), std::lround(1e3 * (out.origin.y() + out.y[i]))});
    return places;
  };
  const auto whole = key_points("1000 m");
  EXPECT_GT(whole.size(), 200u);
  EXPECT_LT(whole.size(), 3000u);
  EXPECT_EQ(key_points("70 m"), whole);
}

}  // namespace
}  // namespace swath::pipeline
