// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/feature_file.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/vector/vector.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double unset = std::numeric_limits<double>::quiet_NaN();

std::vector<SpatialLayer> layers() {
  return {{"wires",
           "Wires",
           SpatialShape::line,
           false,
           {{"name", std::string()}, {"sag", 0.0}, {"returns", std::int64_t{0}}},
           {{{{1000, 2000, 30}, {1100.5, 2000, 28}, {1200, 2001, 31}}, {std::string("A, left"), 4.25, std::int64_t{77}}},
            {{{1000, 2010, 30}, {1100, 2010, 29}}, {std::string("B"), unset, std::int64_t{5}}}}},
          {"pylons", "Pylons", SpatialShape::point, false, {{"top", 0.0}}, {{{{1000, 2005, 32.5}}, {32.5}}}},
          {"roofs", "Roofs", SpatialShape::polygon, false, {}, {{{{0, 0, 5}, {10, 0, 5}, {10, 8, 6}}, {}}}}};
}

TEST(FeatureFile, LinesComeBackWithHeights) {
  const test::TemporaryFolder folder;
  write_gpkg(folder / "a.gpkg", layers(), "EPSG:32632");
  const VectorLines read = read_lines(folder / "a.gpkg");
  ASSERT_EQ(read.lines.size(), 3u);  // two lines and a ring
  EXPECT_EQ(core::Crs(read.crs_wkt).epsg(), 32632);
  EXPECT_EQ(read.lines[0].layer, "wires");
  EXPECT_EQ(read.lines[0].x, (std::vector<double>{1000, 1100.5, 1200}));
  EXPECT_EQ(read.lines[0].z, (std::vector<double>{30, 28, 31}));
  EXPECT_TRUE(read.lines[2].closed);
  EXPECT_EQ(read.lines[2].z, (std::vector<double>{5, 5, 6, 5}));
  EXPECT_EQ(test::entries(folder.path()), 1u);
}

TEST(FeatureFile, DrawingsHoldPolylinesInSpace) {
  const test::TemporaryFolder folder;
  write_dxf(folder / "a.dxf", layers(), "EPSG:32632");
  const VectorLines read = read_lines(folder / "a.dxf");
  ASSERT_EQ(read.lines.size(), 3u);
  EXPECT_EQ(read.lines[0].layer, "WIRES");
  EXPECT_EQ(read.lines[0].z, (std::vector<double>{30, 28, 31}));
  EXPECT_NE(test::read_bytes(folder / "a.dxf").find("POINT"), std::string::npos);
}

TEST(FeatureFile, PolygonsKeepTheirHoles) {
  std::vector<SpatialLayer> roof{layers()[2]};
  roof[0].features[0].holes = {{{6, 1, 5}, {8, 1, 5}, {8, 2, 5}}};
  const test::TemporaryFolder folder;
  for (const char* name : {"a.gpkg", "a.dxf"}) {
    name[2] == 'g' ? write_gpkg(folder / name, roof, "EPSG:32632") : write_dxf(folder / name, roof, "EPSG:32632");
    const VectorLines read = read_lines(folder / name);
    ASSERT_EQ(read.lines.size(), 2u) << name;
    EXPECT_EQ(read.lines[1].x, (std::vector<double>{6, 8, 8, 6})) << name;
  }
  roof[0].features[0].holes[0].pop_back();
  EXPECT_THROW(write_gpkg(folder / "b.gpkg", roof, "EPSG:32632"), core::Error);
}

TEST(FeatureFile, TablesQuoteTextsAndLeaveUnsetNumbersEmpty) {
  const test::TemporaryFolder folder;
  write_feature_csv(folder / "a.csv", layers()[0]);
  EXPECT_EQ(test::read_bytes(folder / "a.csv"), "name,sag,returns\n\"A, left\",4.2500,77\nB,,5\n");
  write_feature_csv(folder / "b.csv", layers()[1]);
  EXPECT_EQ(test::read_bytes(folder / "b.csv"), "x,y,z,top\n1000.000,2005.000,32.500,32.5000\n");
}

TEST(FeatureFile, TheSameLayersAreTheSameBytes) {
  const test::TemporaryFolder folder;
  write_gpkg(folder / "a.gpkg", layers(), "EPSG:32632");
  write_gpkg(folder / "b.gpkg", layers(), "EPSG:32632");
  EXPECT_EQ(test::read_bytes(folder / "a.gpkg"), test::read_bytes(folder / "b.gpkg"));
}

TEST(FeatureFile, AFeatureThatDoesNotFitItsLayerIsAnError) {
  const test::TemporaryFolder folder;
  std::vector<SpatialLayer> one_place = layers(), wrong_kind = layers(), not_finite = layers();
  one_place[0].features[1].places.resize(1);
  wrong_kind[0].features[0].values[1] = std::string("4.25");
  not_finite[1].features[0].places[0].z() = unset;
  for (const auto& faulty : {one_place, wrong_kind, not_finite}) {
    EXPECT_THROW(write_gpkg(folder / "a.gpkg", faulty, "EPSG:32632"), core::Error);
    EXPECT_THROW(write_dxf(folder / "a.dxf", faulty, "EPSG:32632"), core::Error);
  }
  EXPECT_THROW(write_feature_csv(folder / "a.csv", wrong_kind[0]), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::io
