// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/named_areas.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/vector/line_layer.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

LineFeature square(const std::string& name, double x, double y, double side) {
  return {name, {x, x + side, x + side, x, x}, {y, y, y + side, y + side, y}, {}};
}

TEST(NamedAreas, APlaceHasTheNameOfTheAreaAroundIt) {
  const test::TemporaryFolder folder;
  write_line_layer(folder / "a.gpkg", {"sheets", "", {}, {square("north", 0, 100, 100), square("south", 0, 0, 100)}, {}, true},
                   "EPSG:25832");
  const NamedAreas areas(folder / "a.gpkg", "name", "EPSG:25832+7837");
  EXPECT_EQ(areas.at(50, 50), "south");
  EXPECT_EQ(areas.at(50, 150), "north");
  EXPECT_THROW(areas.at(150, 50), core::Error);
}

TEST(NamedAreas, WhatCannotNameATileIsAnError) {
  const test::TemporaryFolder folder;
  write_line_layer(folder / "a.gpkg", {"sheets", "", {}, {square("one", 0, 0, 100), square("two", 50, 0, 100)}, {}, true}, "EPSG:25832");
  const NamedAreas areas(folder / "a.gpkg", "name", "EPSG:25832");
  EXPECT_EQ(areas.at(20, 50), "one");
  EXPECT_THROW(areas.at(70, 50), core::Error) << "overlap";
  EXPECT_THROW(NamedAreas(folder / "a.gpkg", "sheet", "EPSG:25832"), core::Error) << "no such field";
  EXPECT_THROW(NamedAreas(folder / "a.gpkg", "name", "EPSG:25833"), core::Error) << "another CRS";
  EXPECT_THROW(NamedAreas(folder / "b.gpkg", "name", "EPSG:25832"), core::Error) << "no such file";
  for (const char* name : {"../out", "a/b", "a\\b", ".", "", "a\nb"}) {
    write_line_layer(folder / "d.gpkg", {"sheets", "", {}, {square(name, 0, 0, 100)}, {}, true}, "EPSG:25832");
    EXPECT_THROW(NamedAreas(folder / "d.gpkg", "name", "EPSG:25832"), core::Error) << name;
  }
  write_line_layer(folder / "c.gpkg", {"lines", "", {}, {square("one", 0, 0, 100)}}, "EPSG:25832");
  EXPECT_THROW(NamedAreas(folder / "c.gpkg", "name", "EPSG:25832"), core::Error) << "no polygon";
}

}  // namespace
}  // namespace swath::io
