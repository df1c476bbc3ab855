// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/height_statement.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/geo/height_unit.h"
#include "io/vector/feature_file.h"
#include "io/vector/vector_map.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double survey_foot = 1200.0 / 3937.0;

std::optional<double> unit_of(const std::filesystem::path& file) { return read_map(file).height_unit; }

TEST(HeightStatement, ContoursOfThisProgramStateIt) {
  const test::TemporaryFolder folder;
  for (const char* name : {"c.gpkg", "c.dxf", "c.geojson"}) {
    for (const double unit : {1.0, survey_foot}) {
      const auto file = folder / name;
      ContourWriter writer(file, core::with_height_unit(core::Crs("EPSG:2263"), unit));
      writer.add(core::ContourLine{{983000, 983100}, {210000, 210000}, 40.0, false, false, false});
      writer.close();
      const auto stated = unit_of(file);
      ASSERT_TRUE(stated) << name;
      EXPECT_NEAR(*stated, unit, 1e-12) << name;
      std::filesystem::remove(file);
    }
  }
}

TEST(HeightStatement, ACrsStatesItAndFlatFeaturesOfOthersDoNot) {
  const test::TemporaryFolder folder;
  SpatialLayer lines{"lines", "", SpatialShape::line, true, {}, {}};
  lines.features.push_back({{{983000, 210000, 0}, {983100, 210000, 0}}, {}});
  write_gpkg(folder / "flat.gpkg", {lines}, "EPSG:2263");
  EXPECT_FALSE(unit_of(folder / "flat.gpkg"));
  lines.flat = false, lines.vertical = true;
  write_gpkg(folder / "high.gpkg", {lines}, "EPSG:2263+6360");
  EXPECT_NEAR(unit_of(folder / "high.gpkg").value_or(0.0), survey_foot, 1e-12);
  EXPECT_THROW(unit_of(folder / "absent.gpkg"), core::Error);
}

}  // namespace
}  // namespace swath::io
