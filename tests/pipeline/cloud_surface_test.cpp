// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of clouds: tiles without points, lines that lie apart, sigmas.
#include <cmath>
#include <functional>
#include <map>

#include "core/statistics.h"
#include "io/raster/geotiff.h"
#include "tests/pipeline/cloud_case.h"

namespace swath::pipeline {
namespace {

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
