// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/cross_sections.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

/// z = 100 + east_slope * (x - 600000) over 100 m by 100 m.
void write_plane(const std::filesystem::path& file, double east_slope, const std::string& crs) {
  core::Grid g({1.0, 600000, 5300000, 100, 100});
  for (int j = 0; j < 100; ++j)
    for (int i = 0; i < 100; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(100.0 + east_slope * (i + 0.5));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  io::write_grid(file, g, crs);
}

CrossSectionRequest request(const test::TemporaryFolder& folder) {
  CrossSectionRequest r;
  r.axis.dtm = folder / "dtm.tif";
  r.axis.from = "600050,5300010", r.axis.to = "600050,5300085";
  r.axis.folder = folder / "out";
  r.step = 20.0, r.width = 40.0;
  return r;
}

TEST(CrossSections, ALevelDesignInASlopeCutsOneSideAndFillsTheOther) {
  const test::TemporaryFolder folder;
  write_plane(folder / "dtm.tif", 0.1, "EPSG:32632");
  CrossSectionRequest r = request(folder);
  r.level = 105.0;  // the ground's height on the axis
  const auto found = write_cross_sections(r);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].sections, 5u);  // 0, 20, 40, 60 and the end
  EXPECT_EQ(found[0].incomplete, 0u);
  EXPECT_NEAR(found[0].length, 75.0, 1e-6);
  const double area = 0.5 * 20.0 * 2.0;  // a triangle on each side
  EXPECT_NEAR(found[0].cut, area * 75.0, 0.01);
  EXPECT_NEAR(found[0].fill, area * 75.0, 0.01);
  EXPECT_NE(test::read_bytes(folder / "out/sections.csv").find("profile,20.000,600050.000,5300030.000,0.000,105.000,105.000,20.000,20.000"),
            std::string::npos);
}

TEST(CrossSections, BearingsNeedANorthingAxis) {
  const test::TemporaryFolder folder;
  write_plane(folder / "dtm.tif", 0.1, "EPSG:2048");
  CrossSectionRequest r = request(folder);
  r.level = 105.0;
  EXPECT_THROW(write_cross_sections(r), core::Error);
}

TEST(CrossSections, TheAxisThatIsReadIsNotWrittenOverAndItsNameIsOneField) {
  const test::TemporaryFolder folder;
  write_plane(folder / "dtm.tif", 0.0, "EPSG:32632");
  CrossSectionRequest r = request(folder);
  // Its last vertex is there twice; the end is a station all the same.
  const std::string axis = "profile;x;y\nA8, km 3;600050;5300010\nA8, km 3;600050;5300035\nA8, km 3;600050;5300035\n";
  test::write_bytes(folder / "out/sections.csv", axis);
  r.axis.from.clear(), r.axis.to.clear();
  r.axis.lines = folder / "out/sections.csv";
  EXPECT_THROW(write_cross_sections(r), core::Error);
  EXPECT_EQ(test::read_bytes(folder / "out/sections.csv"), axis);
  r.axis.folder = folder / "apart";
  const auto found = write_cross_sections(r);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].sections, 3u);
  EXPECT_NEAR(found[0].length, 25.0, 1e-6);
  EXPECT_NE(test::read_bytes(folder / "apart/sections.csv").find("\n\"A8, km 3\",25.000,"), std::string::npos);
}

TEST(CrossSections, ADesignSurfaceAndWhatIsNotThere) {
  const test::TemporaryFolder folder;
  write_plane(folder / "dtm.tif", 0.0, "EPSG:32632");
  write_plane(folder / "design.tif", 0.02, "EPSG:32632");
  CrossSectionRequest r = request(folder);
  r.design = folder / "design.tif";
  EXPECT_NEAR(write_cross_sections(r)[0].fill, 40.0 * 1.0 * 75.0, 0.5);
  r.width = 140.0;  // beyond the model on both sides
  EXPECT_EQ(write_cross_sections(r)[0].incomplete, 5u);
  write_plane(folder / "other.tif", 0.0, "EPSG:32633");
  r.design = folder / "other.tif";
  EXPECT_THROW(write_cross_sections(r), core::Error);
  r.design.clear();
  r.axis.from = "700050,5300010", r.axis.to = "700050,5300085";
  r.axis.folder = folder / "none";
  EXPECT_THROW(write_cross_sections(r), core::Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "none/sections.csv"));
}

}  // namespace
}  // namespace swath::pipeline
