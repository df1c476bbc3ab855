// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/image_raster.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(ImageRaster, WhatIsWrittenReadsBack) {
  const test::TemporaryFolder folder;
  for (const int bits : {8, 16}) {
    ImageRaster image{37, 21, 3, bits, {}};
    for (size_t k = 0; k < image.at(0, image.rows); ++k)
      image.values.push_back(static_cast<std::uint16_t>(k * 7 % (bits == 8 ? 256 : 65536)));
    write_image_raster(folder.path() / "a.tif", image);
    const ImageRaster back = read_image_raster(folder.path() / "a.tif");
    EXPECT_EQ(back.columns, 37);
    EXPECT_EQ(back.rows, 21);
    EXPECT_EQ(back.bands, 3);
    EXPECT_EQ(back.bits, bits);
    EXPECT_EQ(back.values, image.values);
  }
}

TEST(ImageRaster, AWindowAndTheFactsAlone) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a.tif";
  ImageRaster image{37, 21, 3, 16, {}};
  for (size_t k = 0; k < image.at(0, image.rows); ++k) image.values.push_back(static_cast<std::uint16_t>(k));
  write_image_raster(file, image);
  const ImageRaster part = read_image_window(file, {30, 10, 7, 4});
  EXPECT_EQ(part.columns, 7);
  EXPECT_EQ(part.rows, 4);
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 7; ++c) EXPECT_EQ(part.values[part.at(c, r)], image.values[image.at(30 + c, 10 + r)]);
  EXPECT_THROW(read_image_window(file, {31, 10, 7, 4}), core::Error);
  const ImageRaster facts = read_image_facts(file);
  EXPECT_EQ(facts.columns, 37);
  EXPECT_EQ(facts.rows, 21);
  EXPECT_EQ(facts.bands, 3);
  EXPECT_EQ(facts.bits, 16);
  EXPECT_TRUE(facts.values.empty());
}

TEST(ImageRaster, WhatIsNoImage) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder.path() / "b.jpg", "no image");
  EXPECT_THROW(read_image_raster(folder.path() / "b.jpg"), core::Error);
  EXPECT_THROW(read_image_raster(folder.path() / "none.tif"), core::Error);
}

TEST(ImageRaster, APaletteIsRefused) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "p.tif";
  write_image_raster(file, {4, 1, 1, 8, {0, 1, 1, 0}});
  EXPECT_NO_THROW(read_image_raster(file));
  {
    const GdalMessages messages;
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    ASSERT_TRUE(driver);
    const Dataset set(driver->Create(file.c_str(), 4, 1, 1, GDT_Byte, nullptr));
    ASSERT_TRUE(set);
    const GDALColorEntry red{255, 0, 0, 255}, blue{0, 0, 255, 255};
    GDALColorTable colours;
    colours.SetColorEntry(0, &red), colours.SetColorEntry(1, &blue);
    ASSERT_EQ(set->GetRasterBand(1)->SetColorTable(&colours), CE_None);
  }
  try {
    read_image_raster(file);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("palette"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::io
