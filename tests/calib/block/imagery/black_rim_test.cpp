// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/black_rim.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/block/imagery/undistort.h"
#include "tests/calib/block/imagery/made_photos.h"

namespace swath::calib::test {
namespace {

io::ImageRaster grey(int bands = 3) {
  io::ImageRaster out{60, 40, bands, 8, {}};
  out.values.assign(static_cast<size_t>(out.columns * out.rows * bands), 100);
  return out;
}

void blacken(io::ImageRaster& image, int c0, int r0, int c1, int r1) {
  for (int r = r0; r < r1; ++r)
    for (int c = c0; c < c1; ++c)
      for (int b = 0; b < std::min(image.bands, 3); ++b) image.values[image.at(c, r) + static_cast<size_t>(b)] = 0;
}

TEST(BlackRim, WhatIsBlackFromTheEdgeOnIsHidden) {
  EXPECT_FALSE(BlackRim(grey()).any());
  for (const int bands : {1, 3, 4}) {
    io::ImageRaster image = grey(bands);
    blacken(image, 0, 0, 5, 40);
    blacken(image, 20, 0, 30, 6);
    blacken(image, 40, 20, 45, 25);  // dark ground within
    const BlackRim rim(image);
    EXPECT_TRUE(rim.any());
    EXPECT_TRUE(rim.hides({4.9, 20.0}, 0));
    EXPECT_FALSE(rim.hides({5.1, 20.0}, 0));
    EXPECT_TRUE(rim.hides({5.1, 20.0}, 2));
    EXPECT_TRUE(rim.hides({25.0, 5.9}, 0));
    EXPECT_FALSE(rim.hides({25.0, 6.1}, 0));
    EXPECT_FALSE(rim.hides({42.0, 22.0}, 0));
    EXPECT_FALSE(rim.hides({60.0, 40.0}, 2)) << "an edge without a rim has no margin";
  }
}

TEST(BlackRim, DarkGroundAtTheEdgeOfOnePhotographIsNone) {
  const swath::test::TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (int k = 0; k < 8; ++k) {
    io::ImageRaster image = grey();
    blacken(image, 0, 0, 5, 40);
    blacken(image, 50, 5 * k, 60, 5 * k + 5);
    files.push_back(folder / (std::to_string(k) + ".tif"));
    io::write_image_raster(files.back(), image);
  }
  const BlackRim rim = rim_of(files);
  EXPECT_TRUE(rim.hides({3.0, 20.0}, 0));
  for (int r = 0; r < 40; ++r) EXPECT_FALSE(rim.hides({55.0, r + 0.5}, 2)) << r;
  EXPECT_FALSE(rim_of({}).any());
}

TEST(BlackRim, AnImageWithoutAnyColourIsHidden) {
  io::ImageRaster image = grey();
  blacken(image, 0, 0, 60, 40);
  EXPECT_TRUE(BlackRim(image).hides({30.0, 20.0}, 0));
}

TEST(BlackRim, BandsOfRowsAreTheImageAndCompressionWidensIt) {
  io::ImageRaster image = grey();
  blacken(image, 0, 0, 7, 40);
  BlackRim whole(image), bands(image.columns, image.rows);
  for (int first = 0; first < image.rows; first += 15) {
    io::ImageRaster band = image;
    band.rows = std::min(15, image.rows - first);
    band.values = {image.values.begin() + static_cast<std::ptrdiff_t>(image.at(0, first)),
                   image.values.begin() + static_cast<std::ptrdiff_t>(image.at(0, first + band.rows))};
    bands.add(band, first);
  }
  for (int r = 0; r < image.rows; ++r)
    for (int c = 0; c < image.columns; ++c) EXPECT_EQ(bands.hides({c + 0.5, r + 0.5}, 0), whole.hides({c + 0.5, r + 0.5}, 0));
  EXPECT_FALSE(whole.hides({12.5, 20.5}, 2));
  whole.expect_mixed(16);
  EXPECT_TRUE(whole.hides({12.5, 20.5}, 2)) << "a block of a JPEG";
  EXPECT_FALSE(whole.hides({23.5, 20.5}, 2));
}

TEST(BlackRim, OfAnUndistortedImageItIsWhatTheImageDoesNotShow) {
  CameraConfig camera = made_camera();
  camera.columns = 60, camera.rows = 40, camera.pixel = core::Metres(4e-4);
  camera.k1 = 4e-4;  // 0.06 mm at the corner of 14 mm: the corners are seen, the middle of the sides is not
  camera.distortion = DistortionAt::ideal;
  const io::ImageRaster out = undistorted(grey(), camera, "a");
  const BlackRim rim(out);
  size_t black = 0;
  for (int r = 0; r < out.rows; ++r)
    for (int c = 0; c < out.columns; ++c) {
      const bool is_black = out.values[out.at(c, r)] == 0;
      black += is_black;
      EXPECT_EQ(rim.hides({c + 0.5, r + 0.5}, 0), is_black) << c << " " << r;
    }
  EXPECT_GT(black, 20u);
}

}  // namespace
}  // namespace swath::calib::test
