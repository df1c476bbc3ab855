// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/vrt.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cmath>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// Cells of one world: the height says where the cell is.
core::Grid piece(std::int64_t i0, std::int64_t j0, int nx, int ny, double cell = 2.0) {
  core::Grid g(core::Lattice{cell, i0, j0, nx, ny});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>((i0 + i) * 100 + (j0 + j));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  return g;
}

TEST(Vrt, TilesBecomeOneRasterThatMayBeMoved) {
  const test::TemporaryFolder folder;
  const std::vector<std::filesystem::path> tiles{folder / "s/tiles/a&b_dtm.tif", folder / "s/tiles/c_dtm.tif"};
  write_grid(tiles[0], piece(100, 200, 30, 20), "EPSG:25832+7837");
  core::Grid second = piece(128, 215, 25, 10);                 // two columns and five rows lie over the first tile
  second.height[0] = std::numeric_limits<float>::quiet_NaN();  // empty there: the first tile must show through
  write_grid(tiles[1], second, "EPSG:25832+7837");
  write_vrt(folder / "s/survey_dtm.vrt", {tiles[1], tiles[0]});
  const std::string bytes = test::read_bytes(folder / "s/survey_dtm.vrt");
  write_vrt(folder / "s/survey_dtm.vrt", {tiles[0], tiles[1]});
  EXPECT_EQ(bytes, test::read_bytes(folder / "s/survey_dtm.vrt"));
  EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos);

  std::filesystem::rename(folder / "s", folder / "moved");
  const core::Grid g = read_grid(folder / "moved/survey_dtm.vrt");
  EXPECT_EQ(g.lattice, (core::Lattice{2.0, 100, 200, 53, 25}));
  for (int j = 0; j < g.lattice.ny; ++j)
    for (int i = 0; i < g.lattice.nx; ++i) {
      const bool first = i < 30 && j < 20, other = i >= 28 && j >= 15;
      const float v = g.height[g.lattice.at(i, j)];
      if (first || other)
        ASSERT_EQ(v, static_cast<float>((100 + i) * 100 + 200 + j)) << i << " " << j;
      else
        ASSERT_TRUE(std::isnan(v));
    }
  auto* d = GDALDataset::Open((folder / "moved/survey_dtm.vrt").c_str());
  ASSERT_NE(d, nullptr);
  EXPECT_STREQ(d->GetRasterBand(1)->GetDescription(), "height");
  EXPECT_STREQ(d->GetRasterBand(1)->GetUnitType(), "m");
  EXPECT_EQ(d->GetRasterBand(1)->GetNoDataValue(), raster_nodata);
  ASSERT_NE(d->GetSpatialRef(), nullptr);
  EXPECT_TRUE(d->GetSpatialRef()->IsCompound());
  GDALClose(d);
}

TEST(Vrt, AxisOrderOfTheCrsIsKept) {
  const test::TemporaryFolder folder;
  write_grid(folder / "a.tif", piece(100, 200, 5, 5, 0.001), "EPSG:4326");
  write_vrt(folder / "a.vrt", {folder / "a.tif"});
  const GdalMessages registered;
  auto* d = GDALDataset::Open((folder / "a.vrt").c_str());
  ASSERT_NE(d, nullptr);
  auto* t = GDALDataset::Open((folder / "a.tif").c_str());
  EXPECT_EQ(d->GetSpatialRef()->GetDataAxisToSRSAxisMapping(), t->GetSpatialRef()->GetDataAxisToSRSAxisMapping());
  EXPECT_TRUE(d->GetSpatialRef()->IsSame(t->GetSpatialRef()));
  GDALClose(t);
  GDALClose(d);
}

TEST(Vrt, QualityBandsAreAllThere) {
  const test::TemporaryFolder folder;
  core::Grid g = piece(0, 0, 10, 10);
  g.sigma.assign(g.lattice.size(), 0.125f);
  g.count.assign(g.lattice.size(), 3);
  write_grid(folder / "q.tif", g, "EPSG:32632", quality_bands);
  write_vrt(folder / "q.vrt", {folder / "q.tif"});
  const core::Grid q = read_grid(folder / "q.vrt");
  EXPECT_EQ(q.sigma, g.sigma);
  EXPECT_EQ(q.count, g.count);
  EXPECT_EQ(q.reason, g.reason);
}

TEST(Vrt, TilesThatDoNotFitAreRefused) {
  const test::TemporaryFolder folder;
  write_grid(folder / "a.tif", piece(0, 0, 5, 5), "EPSG:32632");
  write_grid(folder / "cell.tif", piece(0, 0, 5, 5, 1.0), "EPSG:32632");
  write_grid(folder / "crs.tif", piece(0, 0, 5, 5), "EPSG:32633");
  core::Grid g = piece(0, 0, 5, 5);
  write_grid(folder / "reason.tif", g, "EPSG:32632", GridBands{false, false, false, true});
  for (const char* name : {"cell.tif", "crs.tif", "reason.tif", "none.tif"}) {
    EXPECT_THROW(write_vrt(folder / "x.vrt", {folder / "a.tif", folder / name}), core::Error) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.vrt"));
  }
  EXPECT_THROW(write_vrt(folder / "x.vrt", {}), core::Error);
}

}  // namespace
}  // namespace swath::io
