// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/cog.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <iterator>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(Cog, BandsOfBytesWithOverviewsInTilesOf512) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a.tif";
  const core::Lattice lattice{0.5, 1200, 10600000, 700, 600};
  std::vector<std::uint8_t> values(lattice.size());
  for (size_t k = 0; k < values.size(); ++k) values[k] = static_cast<std::uint8_t>(k % 251);
  const GdalMessages messages;
  const Dataset memory = memory_raster(lattice, crs_facts("EPSG:25832"), file);
  add_memory_band(*memory, values, "first");
  write_cog(file, *memory, Overviews::nearest, messages);
  const Dataset made = open_raster(file);
  ASSERT_TRUE(made);
  EXPECT_STREQ(made->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
  GDALRasterBand* band = made->GetRasterBand(1);
  EXPECT_EQ(band->GetRasterDataType(), GDT_Byte);
  EXPECT_STREQ(band->GetDescription(), "first");
  EXPECT_EQ(band->GetOverviewCount(), 1);
  int width = 0, height = 0;
  band->GetBlockSize(&width, &height);
  EXPECT_EQ(width, 512);
  std::vector<std::uint8_t> back(values.size());
  ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, 700, 600, back.data(), 700, 600, GDT_Byte, 0, 0, nullptr), CE_None);
  EXPECT_EQ(back, values);
  double g[6];
  made->GetGeoTransform(g);
  EXPECT_EQ(g[0], 600.0);
  EXPECT_EQ(g[3], 5300300.0);
}

TEST(Cog, WhereItCannotBeWrittenNothingStays) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(memory_raster({1.0, 0, 0, 0, 5}, crs_facts(""), "none.tif"), core::Error);
  const GdalMessages messages;
  std::vector<float> values(4, 1.0f);
  test::write_bytes(folder.path() / "taken", "a file, no folder");
  const auto file = folder.path() / "taken" / "a.tif";
  const Dataset memory = memory_raster({1.0, 0, 0, 2, 2}, crs_facts(""), file);
  add_memory_band(*memory, values, "height");
  EXPECT_THROW(write_cog(file, *memory, Overviews::average, messages), core::Error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()), 1);
}

}  // namespace
}  // namespace swath::io
