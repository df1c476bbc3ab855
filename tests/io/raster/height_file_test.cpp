// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/height_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// 40 by 30 cells of 10 m, rising 0.1 eastward and 0.2 northward.
core::Grid slope() {
  core::Grid g({10.0, 60000, 530000, 40, 30});
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 40; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(100 + i + 2 * j);
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  return g;
}

TEST(HeightFile, APartIsAsTheWhole) {
  const test::TemporaryFolder folder;
  write_grid(folder / "a.tif", slope(), "EPSG:32632");
  const HeightFile whole = read_heights(folder / "a.tif");
  const HeightFile part = read_heights(folder / "a.tif", core::Box{600100, 5300050, 600200, 5300100});
  for (const auto& [x, y] : {std::pair(600100.0, 5300050.0), std::pair(600157.0, 5300093.0), std::pair(600200.0, 5300100.0)}) {
    EXPECT_NEAR(whole.field.height(x, y), 100 + 0.1 * (x - 600005) + 0.2 * (y - 5300005), 1e-4);
    EXPECT_NEAR(part.field.height(x, y), whole.field.height(x, y), 1e-9);
  }
  EXPECT_EQ(part.crs.epsg(), 32632);
  EXPECT_LT(part.field.highest(), whole.field.highest());
  EXPECT_FALSE(part.field.knows(600300, 5300200));
}

/// Pixels that are not square, corners off every lattice, heights in feet.
TEST(HeightFile, OtherPeoplesPixels) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.asc", "ncols 2\nnrows 2\nxllcorner 1003.7\nyllcorner 2001.1\ndx 4\ndy 8\nnodata_value -99\n1 2\n3 -99\n");
  const HeightFile f = read_heights(folder / "a.asc");
  EXPECT_NEAR(f.field.height(1005.7, 2013.1), 1, 1e-6);
  EXPECT_NEAR(f.field.height(1005.7, 2005.1), 3, 1e-6);
  EXPECT_FALSE(f.field.knows(1009.7, 2005.1));
  core::Grid g = slope();
  write_grid(folder / "ft.tif", g, "EPSG:2263+6360");
  EXPECT_NEAR(read_heights(folder / "ft.tif").field.lowest(), 100 * 1200.0 / 3937.0, 1e-3);
}

TEST(HeightFile, WhatIsNoGroundIsRefused) {
  const test::TemporaryFolder folder;
  write_grid(folder / "a.tif", slope(), "EPSG:32632");
  EXPECT_THROW(read_heights(folder / "a.tif", core::Box{0, 0, 100, 100}), core::Error);
  core::Grid none = slope();
  std::fill(none.height.begin(), none.height.end(), std::numeric_limits<float>::quiet_NaN());
  write_grid(folder / "none.tif", none, "EPSG:32632");
  EXPECT_THROW(read_heights(folder / "none.tif"), core::Error);
  core::Grid degrees({0.001, 10000, 47000, 4, 4});
  std::fill(degrees.height.begin(), degrees.height.end(), 1.0f);
  write_grid(folder / "degrees.tif", degrees, "EPSG:4326");
  try {
    read_heights(folder / "degrees.tif");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("degrees"), std::string::npos);
  }
}

}  // namespace
}  // namespace swath::io
