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
    for (const core::Value& s : io::read_value_file(out / "report.json").find("stages")->items())
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

}  // namespace
}  // namespace swath::pipeline
