// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/spot_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/vector/feature_file.h"
#include "io/vector/vector_map.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr const char* utm32 = "EPSG:32632";

SpotFile spots_of(const std::filesystem::path& file, const std::string& field = {}) { return read_map(file, field).spots; }

/// A contour with its label and a spot height, as this program writes them.
void write_contour_file(const std::filesystem::path& file) {
  ContourWriter writer(file, utm32);
  writer.add(core::ContourLine{{500000, 500100}, {5300000, 5300000}, 420.0, false, false, false});
  writer.add(core::ContourLabel{500050, 5300000, "420", 0.0, 5.0, 420.0});
  writer.add(core::SpotHeight{500010, 5300020, 423.4, "423.4", true, 5.0});
  writer.close();
}

TEST(SpotFile, SpotHeightsOfContoursAreReadAndTheirLabelsAreNot) {
  const test::TemporaryFolder folder;
  for (const char* name : {"map.gpkg", "map.dxf"}) {
    write_contour_file(folder / name);
    const SpotFile found = spots_of(folder / name);
    ASSERT_EQ(found.z.size(), 1u) << name;
    EXPECT_NEAR(found.x[0], 500010.0, 1e-3);
    EXPECT_NEAR(found.y[0], 5300020.0, 1e-3);
    EXPECT_NEAR(found.z[0], 423.4, 1e-3);
    EXPECT_EQ(found.crs_wkt.empty(), std::string(name) == "map.dxf");
  }
}

TEST(SpotFile, AStatedFieldStandsBeforeTheUsualOnesAndFlatPointsAreCounted) {
  const test::TemporaryFolder folder;
  SpatialLayer layer{"peaks", "", SpatialShape::point, true, {{"height", 0.0}, {"hoehe", 0.0}}, {}};
  layer.features.push_back({{{1, 2, 0}}, {7.0, 8.0}});
  layer.features.push_back({{{3, 4, 0}}, {9.0, std::nan("")}});
  write_gpkg(folder / "peaks.gpkg", {layer}, utm32);
  const SpotFile usual = spots_of(folder / "peaks.gpkg"), stated = spots_of(folder / "peaks.gpkg", "hoehe");
  EXPECT_EQ(usual.z, (std::vector<double>{7.0, 9.0}));
  EXPECT_EQ(stated.z, std::vector<double>{8.0});
  EXPECT_EQ(stated.without_height, 1u);
  EXPECT_THROW(spots_of(folder / "none.gpkg"), core::Error);
  SpatialLayer words{"peaks", "", SpatialShape::point, true, {{"hoehe", std::string()}}, {}};
  words.features.push_back({{{1, 2, 0}}, {std::string("401,5")}});
  words.features.push_back({{{3, 4, 0}}, {std::string("402.5")}});
  write_gpkg(folder / "words.gpkg", {words}, utm32);
  EXPECT_EQ(spots_of(folder / "words.gpkg", "hoehe").z, std::vector<double>{402.5});
  EXPECT_EQ(spots_of(folder / "words.gpkg", "hoehe").without_height, 1u);
}

}  // namespace
}  // namespace swath::io
