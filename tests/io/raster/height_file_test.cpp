// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/height_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

/// An ASCII grid that declares no value for "none", or the one given.
void write_ascii(const std::filesystem::path& file, const std::string& values, const std::string& nodata = {}) {
  test::write_bytes(file, "ncols 4\nnrows 1\nxllcorner 1000\nyllcorner 2000\ncellsize 10\n" +
                              (nodata.empty() ? "" : "nodata_value " + nodata + "\n") + values + "\n");
}

TEST(HeightFile, HeightsThatNoGroundHasAreVoid) {
  const test::TemporaryFolder folder;
  const auto file = folder / "a.asc";
  const core::Box all{0, 0, 1e4, 1e4};
  const auto impossible = [&] {
    ImpossibleHeights found;
    find_heights(file, all, [&](double, double, double v) { found.add(v); });
    ImpossibleHeights of_grid;
    const core::Grid grid = read_grid(file, std::nullopt, [&](double, double, double v) { of_grid.add(v); });
    EXPECT_EQ(found.count, of_grid.count);
    EXPECT_EQ(static_cast<std::uint64_t>(std::count_if(grid.height.begin(), grid.height.end(), [](float h) { return std::isnan(h); })),
              found.count);
    return found;
  };
  for (const char* none : {"-9999", "-32767", "-32768", "-99999", "9999", "-3.4028235e38", "1e31"}) {
    write_ascii(file, std::string("100.5 101 ") + none + " 102");
    const ImpossibleHeights found = impossible();
    EXPECT_EQ(found.count, 1u) << none;
    EXPECT_NEAR(found.lowest, std::stod(none), 1e-6 * std::abs(std::stod(none))) << none;
    EXPECT_FALSE(read_heights(file).field.knows(1025, 2005)) << none;
  }
  write_ascii(file, "100.5 -430 8848 -10900");
  EXPECT_EQ(impossible().count, 0u);
  write_ascii(file, "-9999 101 99 102.5", "99");  // of a trench: the file declares another value
  EXPECT_EQ(read_heights(file).field.lowest(), -9999.0);
  write_ascii(file, "48000.5 47000 47100 47200");
  EXPECT_THROW(read_heights(file), core::Error);
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
