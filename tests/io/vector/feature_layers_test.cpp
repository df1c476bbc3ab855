// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/feature_layers.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/vector/vector.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<FeatureLayer> layers() {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {{"voids",
           "Areas",
           FeatureShape::polygon,
           {"kind"},
           {"height"},
           {{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{2, 2}, {2, 4}, {4, 4}, {4, 2}}}, {"water"}, {7.5}}}},
          {"marks", "Points", FeatureShape::point, {"name"}, {"z", "slope"}, {{{{{5, 6}}}, {"P <1>"}, {100.25, none}}}},
          {"axis", "Line", FeatureShape::line, {}, {"height"}, {{{{{0, 0}, {3, 4}}}, {}, {1}}}}};
}

TEST(FeatureLayers, ComeBack) {
  const test::TemporaryFolder folder;
  write_feature_layers(folder / "a.gpkg", layers(), "EPSG:32632");
  const VectorLines read = read_lines(folder / "a.gpkg");
  ASSERT_EQ(read.lines.size(), 3u);  // two rings and a line; points are none
  EXPECT_EQ(core::Crs(read.crs_wkt).epsg(), 32632);
  EXPECT_EQ(read.lines[0].layer, "voids");
  EXPECT_EQ(read.lines[0].height, 7.5);
  EXPECT_TRUE(read.lines[0].closed);
  EXPECT_EQ(read.lines[0].x, (std::vector<double>{0, 10, 10, 0, 0}));
  EXPECT_EQ(read.lines[1].y, (std::vector<double>{2, 4, 4, 2, 2}));
  EXPECT_EQ(read.lines[2].layer, "axis");
  EXPECT_EQ(read.lines[2].x, (std::vector<double>{0, 3}));
}

TEST(FeatureLayers, TheSameLayersAreTheSameBytes) {
  const test::TemporaryFolder folder;
  write_feature_layers(folder / "a.gpkg", layers(), "EPSG:32632");
  write_feature_layers(folder / "b.gpkg", layers(), "EPSG:32632");
  EXPECT_EQ(test::read_bytes(folder / "a.gpkg"), test::read_bytes(folder / "b.gpkg"));
  EXPECT_EQ(test::entries(folder.path()), 2u);
}

TEST(FeatureLayers, AFeatureHasAllValuesOfItsLayer) {
  const test::TemporaryFolder folder;
  std::vector<FeatureLayer> less = layers();
  less[1].features[0].numbers.pop_back();
  EXPECT_THROW(write_feature_layers(folder / "a.gpkg", less, "EPSG:32632"), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

TEST(FeatureLayers, AnUnknownCrsLeavesNothing) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_feature_layers(folder / "a.gpkg", layers(), "EPSG:1"), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::io
