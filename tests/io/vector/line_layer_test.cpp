// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/line_layer.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/vector/vector.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

LineLayer layer() {
  return {"flight_lines",
          "Two lines",
          {"order", "height"},
          {{"line 1", {1000, 2000.5}, {5000, 5000}, {1, 700}}, {"line <2>", {2000, 1000}, {5100.25, 5100}, {2, 710}}}};
}

TEST(LineLayer, ComesBack) {
  const test::TemporaryFolder folder;
  write_line_layer(folder / "a.gpkg", layer(), "EPSG:32632");
  const VectorLines read = read_lines(folder / "a.gpkg");
  ASSERT_EQ(read.lines.size(), 2u);
  EXPECT_EQ(core::Crs(read.crs_wkt).epsg(), 32632);
  EXPECT_EQ(read.lines[0].x, (std::vector<double>{1000, 2000.5}));
  EXPECT_EQ(read.lines[1].y, (std::vector<double>{5100.25, 5100}));
  EXPECT_EQ(read.lines[1].height, 710);
  EXPECT_EQ(read.lines[1].layer, "flight_lines");
  EXPECT_EQ(test::entries(folder.path()), 1u);
}

TEST(LineLayer, TheSameLinesAreTheSameBytes) {
  const test::TemporaryFolder folder;
  write_line_layer(folder / "a.gpkg", layer(), "EPSG:32632");
  write_line_layer(folder / "b.gpkg", layer(), "EPSG:32632");
  EXPECT_EQ(test::read_bytes(folder / "a.gpkg"), test::read_bytes(folder / "b.gpkg"));
}

TEST(LineLayer, AFileInThePlaceOfTheFolderIsAnError) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "none", "x");
  EXPECT_THROW(write_line_layer(folder / "none" / "a.gpkg", layer(), "EPSG:32632"), core::Error);
}

}  // namespace
}  // namespace swath::io
