// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/las/las_writer.h"
#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

double ground(double x, double y) { return 100.0 + 0.1 * (x - 600000.0) - 0.05 * (y - 5300000.0); }

/// Ground points and roofs 6 m above every metre of 80 m by 80 m.
void make_cloud(const std::filesystem::path& file, const std::string& crs) {
  core::Block b;
  b.origin = {600000.0, 5300000.0, 0.0};
  core::resize(b, 80 * 80);
  core::add_columns(b, {core::Column::classification, core::Column::return_number, core::Column::return_count, core::Column::flags});
  for (int j = 0; j < 80; ++j)
    for (int i = 0; i < 80; ++i) {
      const auto k = static_cast<size_t>(j * 80 + i);
      const bool roof = i >= 30 && i < 40;
      b.x[k] = i + 0.5;
      b.y[k] = j + 0.5;
      b.z[k] = ground(b.x[k] + 600000.0, b.y[k] + 5300000.0) + (roof ? 6.0 : 0.0);
      b.classification[k] = roof ? 6 : 2;
      b.return_number[k] = b.return_count[k] = 1;
    }
  io::LasWriteOptions o;
  o.crs_wkt = core::Crs(crs).wkt1();
  io::LasWriter writer(file, o);
  writer.write(b);
  writer.finish();
}

/// The same and a terrain model of them.
void make(const test::TemporaryFolder& folder) {
  make_cloud(folder / "points.laz", "EPSG:32632");
  core::Grid g(core::Lattice{1.0, 600000, 5300000, 80, 80});
  for (int j = 0; j < 80; ++j)
    for (int i = 0; i < 80; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(ground(g.lattice.centre_x(i), g.lattice.centre_y(j)));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  io::write_grid(folder / "dtm.tif", g, "EPSG:32632");
}

struct Row {
  std::string kind;
  double station, offset, x, y, z;
  std::string point_class;
};

std::vector<Row> rows_of(const std::filesystem::path& file) {
  std::istringstream in(test::read_bytes(file));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "kind,station,offset,x,y,z,sigma,class");
  std::vector<Row> out;
  while (std::getline(in, line)) {
    std::istringstream fields(line + ",");
    std::vector<std::string> f;
    for (std::string one; std::getline(fields, one, ',');) f.push_back(one);
    EXPECT_GE(f.size(), 7u) << line;
    out.push_back({f[0], std::stod(f[1]), std::stod(f[2]), std::stod(f[3]), std::stod(f[4]), std::stod(f[5]), f.size() > 7 ? f[7] : ""});
  }
  return out;
}

TEST(Profile, PointsWithinTheWidthByTheirClassAndTheTerrain) {
  const test::TemporaryFolder folder;
  make(folder);
  ProfileRequest r;
  r.dtm = folder / "dtm.tif";
  r.points = {folder.path()};
  r.from = "600005,5300010";
  r.to = "600065,5300055";  // 75 m in the direction (0.8, 0.6)
  r.half_width = 2.0;
  r.folder = folder / "out";
  const std::vector<ProfileFound> found = write_profiles(r);
  ASSERT_EQ(found.size(), 1u);
  const auto rows = rows_of(folder / "out/profile.csv");
  size_t points = 0, roofs = 0, terrain = 0;
  for (const Row& row : rows) {
    const double station = 0.8 * (row.x - 600005.0) + 0.6 * (row.y - 5300010.0),
                 offset = 0.6 * (row.x - 600005.0) - 0.8 * (row.y - 5300010.0);
    EXPECT_NEAR(row.station, station, 2e-3);  // three decimals of each
    EXPECT_NEAR(row.offset, offset, 2e-3);
    if (row.kind == "terrain") {
      ++terrain;
      EXPECT_NEAR(row.z, ground(row.x, row.y), 1e-3);
      continue;
    }
    ++points;
    const bool roof = row.x >= 600030.0 && row.x < 600040.0;
    roofs += row.point_class == "6";
    EXPECT_EQ(row.point_class, roof ? "6" : "2");
    EXPECT_NEAR(row.z, ground(row.x, row.y) + (roof ? 6.0 : 0.0), 1.5e-3);
    EXPECT_LE(std::abs(row.offset), 2.0005);
  }
  EXPECT_EQ(terrain, 151u);                                  // 75 m by half metres
  EXPECT_NEAR(static_cast<double>(points), 75.0 * 4.0, 20);  // one a square metre
  EXPECT_GT(roofs, 30u);
  const std::string svg = test::read_bytes(folder / "out/profile.svg");
  for (const char* word : {"<svg", "ground", "building", "terrain model", "height (m)"})
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/profile.png"));
}

TEST(Profile, SeveralLinesOfATextAndBends) {
  const test::TemporaryFolder folder;
  make(folder);
  test::write_bytes(
      folder / "lines.csv",
      "profile,x,y\nroad,600005,5300005\nroad,600045,5300005\nroad,600045,5300035\nditch,600010,5300070\nditch,600070,5300070\n");
  ProfileRequest r;
  r.points = {folder / "points.laz"};
  r.lines = folder / "lines.csv";
  r.folder = folder / "out";
  const std::vector<ProfileFound> found = write_profiles(r);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].name, "road");
  EXPECT_NEAR(found[0].length, 70.0, 1e-9);
  for (const Row& row : rows_of(folder / "out/road.csv"))
    EXPECT_NEAR(row.station, row.station <= 40.0 ? row.x - 600005.0 : 40.0 + row.y - 5300005.0, 1e-3);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/ditch.png"));
}

TEST(Profile, ALineInAnotherCrsIsBroughtToThatOfTheData) {
  const test::TemporaryFolder folder;
  make(folder);
  const core::Transform to_degrees(core::Crs("EPSG:32632"), core::Crs("EPSG:4326"));
  const Eigen::Vector3d from = to_degrees({600005, 5300010, 0}), to = to_degrees({600065, 5300055, 0});
  char text[300];
  std::snprintf(text, sizeof text, R"({"type":"LineString","coordinates":[[%.11f,%.11f],[%.11f,%.11f]]})", from.x(), from.y(), to.x(),
                to.y());
  test::write_bytes(folder / "axis.geojson", text);
  ProfileRequest r;
  r.dtm = folder / "dtm.tif";
  r.lines = folder / "axis.geojson";
  r.folder = folder / "out";
  const std::vector<ProfileFound> found = write_profiles(r);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].length, 75.0, 1e-3);
  EXPECT_GE(found[0].terrain_samples, 150);
}

TEST(Profile, ALongLineAcrossAModelHoldsOnlyWhatLiesAlongIt) {
  // From one tile to another 100 km away: a bounding box of 1e10 cells.
  const test::TemporaryFolder folder;
  make(folder);
  core::Grid far(core::Lattice{1.0, 700000, 5400000, 80, 80});
  std::fill(far.height.begin(), far.height.end(), 7.0f);
  std::fill(far.reason.begin(), far.reason.end(), core::Void::none);
  io::write_grid(folder / "far.tif", far, "EPSG:32632");
  io::write_vrt(folder / "all.vrt", {folder / "dtm.tif", folder / "far.tif"});
  ProfileRequest r;
  r.dtm = folder / "all.vrt";
  r.from = "600010,5300010";
  r.to = "700070,5400070";
  r.folder = folder / "out";
  write_profiles(r);
  size_t here = 0, there = 0;
  for (const Row& row : rows_of(folder / "out/profile.csv")) {
    here += row.x < 600080.0 && std::abs(row.z - ground(row.x, row.y)) < 1e-3;
    there += row.x > 700000.0 && row.z == 7.0;
  }
  EXPECT_GE(here, 190u);  // 69 of the diagonal's 70 m, times the square root of two, every half metre
  EXPECT_GE(there, 190u);
}

TEST(Profile, TheFileOfTheLinesIsNotWrittenOver) {
  const test::TemporaryFolder folder;
  make(folder);
  const std::string lines = "profile,x,y\naxis,600005,5300005\naxis,600045,5300005\n";
  test::write_bytes(folder / "axis.csv", lines);
  ProfileRequest r;
  r.dtm = folder / "dtm.tif";
  r.lines = folder / "axis.csv";
  r.folder = folder.path();
  EXPECT_THROW(write_profiles(r), core::Error);
  EXPECT_EQ(test::read_bytes(folder / "axis.csv"), lines);
}

TEST(Profile, AVertexFarAwayCostsNothing) {
  const test::TemporaryFolder folder;
  make(folder);
  test::write_bytes(folder / "lines.csv",
                    "profile,x,y\nfar,600010,5300040\nfar,90000000,5300040\nwild,600010,5300040\nwild,1e12,5300040\nwild,600050,5300040\n");
  ProfileRequest r;
  r.dtm = folder / "dtm.tif";
  r.lines = folder / "lines.csv";
  r.folder = folder / "out";
  const std::vector<ProfileFound> found = write_profiles(r);
  EXPECT_NEAR(static_cast<double>(found[0].terrain_samples), 140.0, 2.0);  // 70 m by half metres
  EXPECT_EQ(found[1].vertices_left_out, 1);
  EXPECT_EQ(found[1].terrain_samples, 81);
}

TEST(Profile, FilesOfTwoSystemsAreRefusedByTheirNames) {
  const test::TemporaryFolder folder;
  make(folder);
  make_cloud(folder / "other_zone.laz", "EPSG:32633");
  make_cloud(folder / "feet.laz", "EPSG:32632+6360");  // heights in US survey feet
  make_cloud(folder / "levelled.laz", "EPSG:32632+5773");
  ProfileRequest r;
  r.from = "600005,5300010";
  r.to = "600065,5300055";
  r.folder = folder / "out";
  const auto fault = [&](const std::filesystem::path& dtm, const std::vector<std::filesystem::path>& points) {
    r.dtm = dtm;
    r.points = points;
    try {
      write_profiles(r);
    } catch (const core::Error& e) {
      return e.text();
    }
    return std::string();
  };
  for (const char* name : {"other_zone.laz", "feet.laz"}) {
    for (const std::string& text : {fault(folder / "dtm.tif", {folder / name}), fault({}, {folder / "points.laz", folder / name})}) {
      EXPECT_NE(text.find(name), std::string::npos) << text;
      EXPECT_TRUE(text.find("dtm.tif") != std::string::npos || text.find("points.laz") != std::string::npos) << text;
    }
    EXPECT_FALSE(std::filesystem::exists(r.folder));
  }
  EXPECT_EQ(fault(folder / "dtm.tif", {folder / "levelled.laz"}), "") << "the model states nothing of its heights";
}

TEST(Profile, ASectionWithoutPointsIsWarnedOf) {
  const test::TemporaryFolder folder;
  make(folder);
  ProfileRequest r;
  r.dtm = folder / "dtm.tif";
  r.from = "600005,5300010.1";
  r.to = "600065,5300010.1";
  r.half_width = 0.2;
  r.folder = folder / "out";
  EXPECT_EQ(write_profiles(r)[0].warning, "");
  r.points = {folder / "points.laz"};
  const ProfileFound none = write_profiles(r)[0];
  EXPECT_EQ(none.points, 0u);
  EXPECT_NE(none.warning.find("no point"), std::string::npos);
  r.half_width = 1.0;
  EXPECT_EQ(write_profiles(r)[0].warning, "");
}

TEST(Profile, WhatIsNotThereIsAnError) {
  const test::TemporaryFolder folder;
  make(folder);
  ProfileRequest r;
  r.points = {folder / "points.laz"};
  r.folder = folder / "out";
  EXPECT_THROW(write_profiles(r), core::Error);
  r.from = "600005,5300010";
  r.to = "nowhere";
  EXPECT_THROW(write_profiles(r), core::Error);
  r.to = "600005,5300010";
  EXPECT_THROW(write_profiles(r), core::Error);  // no length
  r.from = "0,0";
  r.to = "100,0";
  EXPECT_THROW(write_profiles(r), core::Error);  // no data there
  test::write_bytes(folder / "bad.csv", "a,b\n1,2\n");
  r.lines = folder / "bad.csv";
  EXPECT_THROW(write_profiles(r), core::Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace swath::pipeline
