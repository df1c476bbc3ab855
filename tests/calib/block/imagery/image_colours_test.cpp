// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/image_colours.h"

#include <gtest/gtest.h>

#include "io/raster/image_raster.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

/// An image whose red is 4 per column and green 4 per row.
OrientedImages ramp(const std::filesystem::path& file, int bands, int bits) {
  io::ImageRaster raster{60, 40, bands, bits, {}};
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 60; ++c)
      for (int b = 0; b < bands; ++b) raster.values.push_back(static_cast<std::uint16_t>(b == 0 ? 4 * c : b == 1 ? 4 * r : 7 + b));
  io::write_image_raster(file, raster);
  OrientedImages out;
  out.configs.emplace_back();
  out.configs[0].columns = 60, out.configs[0].rows = 40;
  out.images.emplace_back();
  out.images[0].file = file;
  return out;
}

TEST(ImageColours, BilinearBetweenPixelCentresOver16Bits) {
  const test::TemporaryFolder folder;
  const OrientedImages images = ramp(folder.path() / "a.tif", 3, 8);
  const std::vector<Colour> colours = colours_of(images, {{0, 10.5f, 20.5f}, {0, 11.25f, 20.75f}, {}, {0, 0.0f, 0.0f}, {0, 60.0f, 40.0f}});
  EXPECT_EQ(colours[0], (Colour{40 * 256, 80 * 256, 9 * 256}));
  EXPECT_EQ(colours[1], (Colour{43 * 256, 81 * 256, 9 * 256}));
  EXPECT_EQ(colours[2], (Colour{0, 0, 0}));
  EXPECT_EQ(colours[3], (Colour{0, 0, 9 * 256}));  // at the rim as in the outermost pixel
  EXPECT_EQ(colours[4], (Colour{59 * 4 * 256, 39 * 4 * 256, 9 * 256}));
}

TEST(ImageColours, TheMeanOverASquare) {
  const test::TemporaryFolder folder;
  io::ImageRaster raster{40, 40, 1, 16, {}};
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) raster.values.push_back((r + c) % 2 ? 1000 : 3000);
  OrientedImages images = ramp(folder.path() / "b.tif", 1, 16);
  io::write_image_raster(folder.path() / "b.tif", raster);
  images.configs[0].columns = 40;
  const std::vector<Colour> colours = colours_of(images, {{0, 20.5f, 20.5f}, {0, 20.0f, 20.0f, 8.0f}});
  EXPECT_EQ(colours[0], (Colour{3000, 3000, 3000}));  // of one band all three
  EXPECT_NEAR(colours[1][0], 2000, 1);
}

TEST(ImageColours, SixteenBitsAndAFourthBandStay) {
  const test::TemporaryFolder folder;
  const OrientedImages images = ramp(folder.path() / "c.tif", 4, 16);
  EXPECT_EQ(colours_of(images, {{0, 30.5f, 5.5f}})[0], (Colour{120, 20, 9}));
}

}  // namespace
}  // namespace swath::calib
