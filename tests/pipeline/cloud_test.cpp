// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds that enter after georeferencing: units, files that differ, tiles without points.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "core/geo/crs.h"
#include "core/statistics.h"
#include "io/las/las_reader.h"
#include "io/las/las_writer.h"
#include "io/raster/geotiff.h"
#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "tests/io/las_sample.h"
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
  void add(const io::LasHeader& header, const io::LasPoints& points, const std::string& name, const std::string& more = {}) {
    test::write_sample(folder / name, header, points, 1);
    survey += "[[points]]\nfile = \"" + name + "\"\ncrs = \"EPSG:32632\"\n" + more;
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

/// The only file of points of a run.
fs::path only_tile(const fs::path& out) {
  std::vector<fs::path> tiles;
  for (const auto& e : fs::directory_iterator(out / "points"))
    if (e.path().extension() != ".vrt" && e.path().extension() != ".txt") tiles.push_back(e.path());
  std::erase_if(tiles, [](const fs::path& f) { return f.extension() != ".las" && f.extension() != ".laz"; });
  EXPECT_EQ(tiles.size(), 1u);
  return tiles.at(0);
}

/// Tallies of a run's stages as text.
std::string tallies_of(const fs::path& out) {
  std::string text;
  const core::Value report = io::read_value_file(out / "report.json");
  for (const core::Value& stage : report.find("stages")->items())
    if (const core::Value* tally = stage.find("tally")) text += io::to_json(*tally);
  return text;
}

/// A header whose points lie in one tile.
io::LasHeader header_of(int format, bool extras = false) {
  io::LasHeader h = test::sample_header(format, -1, extras);
  h.offset = {easting + 50000.0, northing + 50000.0, -100.0};
  return h;
}

/// Made points without the heights beyond any place of the Earth that readers leave out.
io::LasPoints points_for(const io::LasHeader& h, size_t n) {
  io::LasPoints p = test::sample_points(h, n);
  for (size_t i = 0; i < n; ++i) {
    p.raw_z[i] %= 500;
    p.z[i] = p.raw_z[i] * h.scale.z() + h.offset.z();
  }
  return p;
}

TEST(Cloud, EveryFieldOfEveryFormatIsKept) {
  for (int format = 0; format <= 10; ++format) {
    CloudCase c;
    io::LasHeader h = header_of(format, true);
    h.scale = {0.0001, 0.0001, 0.0025};
    h.guid.fill(0x5C);
    h.creation_day = 200, h.creation_year = 2015;
    io::LasPoints p = points_for(h, 3000);
    p.return_number[0] = p.return_count[0] = 0;
    p.return_number[1] = 5, p.return_count[1] = 2;
    c.add(h, p, "a.las");
    const fs::path tile = only_tile(c.run(copy_stages, "100 km"));
    EXPECT_EQ(test::read_all(tile, 1), p) << format;
    const io::LasReader r(tile, 1);
    EXPECT_EQ(r.header().point_format, format);
    EXPECT_EQ(r.header().scale, h.scale);
    EXPECT_EQ(r.header().offset, h.offset);
    EXPECT_EQ(r.header().guid, h.guid);
    EXPECT_EQ(r.header().creation_year, 2015);
    EXPECT_EQ(r.header().file_source_id, 7);
  }
}

TEST(Cloud, TimesAgainstTheBitAreKeptAndNamed) {
  CloudCase c;
  io::LasHeader h = header_of(8);
  h.global_encoding = io::las_encoding::wkt;  // seconds of week, says the bit
  const io::LasPoints p = points_for(h, 1000);
  c.add(h, p, "a.las");
  const fs::path out = c.run(copy_stages, "100 km");
  EXPECT_EQ(test::read_all(only_tile(out), 1).gps_time, p.gps_time);
  EXPECT_FALSE(io::LasReader(only_tile(out), 1).header().gps_time_is_adjusted());
  EXPECT_NE(tallies_of(out).find("contradict"), std::string::npos);
  EXPECT_NE(tallies_of(out).find("time_scale"), std::string::npos);
}

TEST(Cloud, AStatedScaleSetsTheBitAndNoTime) {
  CloudCase c;
  io::LasHeader h = header_of(8);
  h.global_encoding = io::las_encoding::wkt;
  const io::LasPoints p = points_for(h, 1000);
  c.add(h, p, "a.las", "time_scale = \"gps_adjusted\"\n");
  const fs::path out = c.run(copy_stages, "100 km");
  EXPECT_EQ(test::read_all(only_tile(out), 1).gps_time, p.gps_time);
  EXPECT_TRUE(io::LasReader(only_tile(out), 1).header().gps_time_is_adjusted());
  EXPECT_EQ(tallies_of(out).find("contradict"), std::string::npos);
}

TEST(Cloud, SecondsOfAWeekStayAsRecordedUnlessAsked) {
  io::LasHeader h = header_of(1);
  h.global_encoding = 0;
  io::LasPoints p = points_for(h, 1000);
  for (size_t i = 0; i < p.size(); ++i) p.gps_time[i] = 604700.1 + 0.01 * static_cast<double>(i);
  CloudCase kept, dated;
  kept.add(h, p, "a.las", "week = 2000\n");
  EXPECT_EQ(test::read_all(only_tile(kept.run(copy_stages, "100 km")), 1).gps_time, p.gps_time);
  dated.add(h, p, "a.las", "week = 2000\n");
  const fs::path tile = only_tile(dated.run(copy_stages + "times = \"adjusted\"\n", "100 km"));
  EXPECT_TRUE(io::LasReader(tile, 1).header().gps_time_is_adjusted());
  EXPECT_NEAR(test::read_all(tile, 1).gps_time[5], 2000 * 604800.0 + p.gps_time[5] - 1e9, 1e-6);
}

TEST(Cloud, ReturnNumbersOfACloudStayUnlessAsked) {
  io::LasHeader h = header_of(6);
  io::LasPoints p = points_for(h, 1000);
  std::fill(p.return_number.begin(), p.return_number.end(), std::uint8_t{0});
  for (size_t i = 0; i < p.size(); ++i) p.gps_time[i] = 3e8 + 1e-4 * static_cast<double>(i / 2);
  const std::string stages = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.returns\"\n",
                    write = "[[stage]]\ntype = \"writers.las\"\n";
  CloudCase kept, repaired;
  kept.add(h, p, "a.las");
  EXPECT_EQ(test::read_all(only_tile(kept.run(stages + write, "100 km")), 1), p);
  repaired.add(h, p, "a.las");
  const io::LasPoints q = test::read_all(only_tile(repaired.run(stages + "repair_clouds = true\n" + write, "100 km")), 1);
  EXPECT_EQ(q.return_number[0] + q.return_number[1], 3);
  EXPECT_EQ(q.return_count[0], 2);
}

TEST(Cloud, KeptClassesAreRespected) {
  CloudCase c;
  Block b = square(4000, easting, northing, 100, 10);
  b.classification.assign(b.size(), core::point_class::unassigned);
  for (size_t i = 0; i < b.size(); i += 4) b.classification[i] = core::point_class::building;
  for (size_t i = 1; i < b.size(); i += 40) b.classification[i] = core::point_class::ground;
  c.add(b, "a.las", "EPSG:32632");
  const auto classes_with = [&](const std::string& keep) {
    std::map<int, size_t> n;
    const fs::path out = c.run("[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.ground\"\nkeep_classes = \"" + keep +
                                   "\"\n[[stage]]\ntype = \"writers.las\"\ncompress = false\n",
                               "1000 m");
    for (const std::uint8_t k : points_of(out).classification) ++n[k];
    fs::remove_all(out);
    return n;
  };
  const size_t nearly_all = 90;  // % of what the filter may call ground: the rim of the square is its own affair
  std::map<int, size_t> anew = classes_with("none"), rest = classes_with("all");
  EXPECT_EQ(anew[6], 0u);
  EXPECT_GT(anew[2], 4000 * nearly_all / 100);
  EXPECT_EQ(classes_with("ground"), (std::map<int, size_t>{{1, 2900}, {2, 100}, {6, 1000}}));
  EXPECT_EQ(rest[6], 1000u);
  EXPECT_GT(rest[2], 3000 * nearly_all / 100);
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

/// Contours as text and the grid's heights: what tiling must not change.
std::string surface_of(CloudCase& c, const std::string& tile) {
  const fs::path out = c.run(
      "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"terrain.contours\"\n"
      "[[stage]]\ntype = \"writers.gdal\"\n",
      tile);
  const core::Value report = io::read_value_file(out / "report.json");
  const core::Value& dtm = report.find("stages")->items()[2];  // behind quality.lines, which it implies
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

TEST(Cloud, ASquareWithBothItsRimsHasNoTilesAndCellsOfRimPointsAlone) {
  CloudCase c;
  Block b = square(20000, easting, northing, 200, 0);
  for (size_t i = 0; i < 10; ++i) b.x[i] = 200.0, b.y[10 + i] = 200.0;
  b.x[19] = 200.0;  // the corner
  for (size_t i = 0; i < b.size(); ++i) b.z[i] = 100 + 0.1 * b.x[i] + 5 * std::sin(b.y[i] / 20);
  b.classification.assign(b.size(), core::point_class::ground);
  b.return_number.assign(b.size(), 1);
  b.return_count.assign(b.size(), 1);
  c.add(b, "square.las", "EPSG:32632");
  const auto cells_of = [&](const std::string& tile, size_t tiles) {
    const fs::path out = c.run(
        copy_stages + "[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"terrain.dsm\"\n[[stage]]\ntype = \"writers.gdal\"\n", tile);
    const Block all = points_of(out);
    EXPECT_EQ(all.size(), b.size());
    size_t on_rim = 0;
    for (size_t i = 0; i < all.size(); ++i)
      on_rim +=
          std::abs(all.origin.x() + all.x[i] - easting - 200.0) < 1e-6 || std::abs(all.origin.y() + all.y[i] - northing - 200.0) < 1e-6;
    EXPECT_EQ(on_rim, 20u) << "coordinates are as they were";
    for (const std::string product : {"points", "dtm", "dsm"}) {
      size_t files = 0;
      for (const auto& e : fs::directory_iterator(out / product)) {
        const std::string name = e.path().filename().string();
        files += name.ends_with(".las") || (name.ends_with(".tif") && !name.ends_with("_quality.tif"));
      }
      EXPECT_EQ(files, tiles) << product << " " << tile;
    }
    std::string cells;
    const core::Value report = io::read_value_file(out / "report.json");
    for (const core::Value& s : report.find("stages")->items())
      if (const core::Value* tally = s.find("tally"); tally && tally->find("cells with a height"))
        cells += std::to_string(tally->find("cells with a height")->find("count")->as_int()) + " ";
    return cells;
  };
  const std::string whole = cells_of("200 m", 1);
  EXPECT_EQ(cells_of("100 m", 4), whole);
  EXPECT_EQ(cells_of("70 m", 16), whole);
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

/// Lines of a plain, 60 m wide every 40 m; line n lies `offset(n)` too high. What they see twice is 20 m wide.
Block plain(int lines, const std::function<double(int)>& offset) {
  Block all;
  for (int line = 1; line <= lines; ++line) {
    Block b = square(24000, easting, northing, 1.0, 100.0);
    for (size_t i = 0; i < b.size(); ++i) {
      b.x[i] = 60.0 * b.x[i] + 40.0 * (line - 1);
      b.y[i] = 200.0 * std::fmod(b.y[i] + 0.37 * line, 1.0);
      b.z[i] += 0.5 * std::sin(b.x[i] / 30.0) + offset(line) + 0.04 * std::fmod(static_cast<double>(i) * 0.569840, 1.0) - 0.02;
    }
    b.strip.assign(b.size(), static_cast<std::uint16_t>(line));
    core::append(all, b);
  }
  return all;
}

std::string lines_of(CloudCase& c, const std::string& tile) {
  return test::read_bytes(c.run("[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"quality.lines\"\n", tile) / "lines.json");
}

TEST(Cloud, LinesAreComparedWithoutATrajectory) {
  CloudCase c;
  c.add(plain(3, [](int line) { return line == 2 ? 0.12 : 0.0; }), "lines.las", "EPSG:32632");
  const std::string whole = lines_of(c, "1000 m");
  const core::Value found = io::parse_json(whole, "lines.json");
  const std::vector<double> expected{-0.04, 0.08, -0.04};
  ASSERT_EQ(found.find("lines")->items().size(), 3u);
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.find("lines")->items()[k].find("offset_m")->as_number(), expected[k], 0.003) << k;
  EXPECT_NEAR(found.find("scatter_m")->as_number(), 0.04 / std::sqrt(12.0), 0.004);  // the errors are evenly spread, not random
  EXPECT_NEAR(found.find("common_m")->as_number(), 0.12 / std::sqrt(2.0), 0.005);
  EXPECT_LT(found.find("residual_m")->as_number(), 0.005);
  EXPECT_EQ(lines_of(c, "70 m"), whole);
  EXPECT_EQ(lines_of(c, "33 m"), whole);
}

TEST(Cloud, GroundIsNotLostBetweenLinesThatLieApart) {
  const auto ground_of = [](double apart, const std::string& before) {
    CloudCase c;
    const Block b = plain(3, [apart](int line) { return line == 2 ? apart : 0.0; });
    c.add(b, "lines.las", "EPSG:32632");
    const Block out = points_of(c.run("[[stage]]\ntype = \"readers.las\"\n" + before +
                                          "[[stage]]\ntype = \"filters.ground\"\n[[stage]]\ntype = \"writers.las\"\ncompress = false\n",
                                      "500 m"));
    double heights = 0.0;
    for (size_t i = 0; i < b.size(); ++i) heights += b.z[i];
    for (size_t i = 0; i < out.size(); ++i) heights -= out.origin.z() + out.z[i];
    EXPECT_NEAR(heights / static_cast<double>(b.size()), 0.0, 1e-4);  // as they were
    return static_cast<double>(std::count(out.classification.begin(), out.classification.end(), core::point_class::ground)) /
           static_cast<double>(out.size());
  };
  const std::string compared = "[[stage]]\ntype = \"quality.lines\"\n";
  const double together = ground_of(0.0, compared);
  EXPECT_GT(together, 0.98);
  for (const double apart : {0.05, 0.10, 0.15}) EXPECT_GT(ground_of(apart, compared), together - 0.01) << apart;
  EXPECT_EQ(ground_of(0.15, ""), ground_of(0.15, compared));  // the filter has them compared where the plan does not say so
  EXPECT_LT(ground_of(0.15, "[[stage]]\ntype = \"quality.lines\"\nleast = 1000\n"), together - 0.02);  // nothing compared: why it does
}

/// Median sigma of the terrain model of a cloud of ground points.
double model_sigma(CloudCase& c, const std::string& option) {
  const fs::path out = c.run(
      "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n" + option + "[[stage]]\ntype = \"writers.gdal\"\n", "500 m");
  std::vector<double> values;
  for (const double v : io::read_raster(out / "dtm_quality.vrt").values)
    if (!std::isnan(v)) values.push_back(v);
  return core::median(values);
}

TEST(Cloud, AModelOfPointsWithoutASigmaHasOne) {
  CloudCase c;
  Block b = plain(3, [](int line) { return line == 2 ? 0.12 : 0.0; });
  b.classification.assign(b.size(), core::point_class::ground);
  c.add(b, "lines.las", "EPSG:32632");
  EXPECT_NEAR(model_sigma(c, ""), 0.12 / std::sqrt(2.0), 0.02);
  EXPECT_NEAR(model_sigma(c, "assumed_sigma = \"0.25 m\"\n"), 0.25, 0.02);
}

TEST(Cloud, ErrorsOfPlaceCountOnSlopes) {
  constexpr double slope = 0.6, aside = 0.2;
  CloudCase apart, together;  // in one of them the second line lies to the west by so much
  for (CloudCase* c : {&apart, &together}) {
    Block b = plain(3, [&](int line) { return c == &apart && line == 2 ? slope * aside : 0.0; });
    for (size_t i = 0; i < b.size(); ++i) b.z[i] += slope * b.x[i];
    b.classification.assign(b.size(), core::point_class::ground);
    c->add(b, "lines.las", "EPSG:32632");
  }
  EXPECT_GT(model_sigma(apart, ""), 0.5 * slope * aside);
  const std::string assumed = "assumed_sigma = \"0.1 m\"\n", farther = "assumed_horizontal = \"0.4 m\"\n";
  EXPECT_NEAR(model_sigma(together, assumed), std::hypot(0.1, slope * 0.1), 0.01);  // as large along each axis
  EXPECT_NEAR(model_sigma(together, assumed + farther), std::hypot(0.1, slope * 0.4), 0.01);
  EXPECT_THROW(model_sigma(together, farther), core::Error);
}

}  // namespace
}  // namespace swath::pipeline
