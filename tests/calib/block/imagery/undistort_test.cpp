// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/undistort.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

constexpr int columns = 120, rows = 80;

CameraConfig camera() {
  CameraConfig c;
  c.f = core::Metres(0.02), c.columns = columns, c.rows = rows, c.pixel = core::Metres(1e-4);  // 12 x 8 mm
  c.distortion = DistortionAt::ideal;
  return c;
}

/// Linear in the pixel: bilinear interpolation is exact.
io::ImageRaster plane_image() {
  io::ImageRaster image{columns, rows, 2, 16, {}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      image.values.push_back(static_cast<std::uint16_t>(1000 + 100 * c));
      image.values.push_back(static_cast<std::uint16_t>(1000 + 100 * r));
    }
  return image;
}

TEST(Undistort, ACameraWithoutDistortionChangesNothing) {
  EXPECT_EQ(undistorted(plane_image(), camera(), "a").values, plane_image().values);
}

TEST(Undistort, ThePrincipalPointMovesToTheMiddle) {
  CameraConfig c = camera();
  c.x0 = core::Metres(3e-4), c.y0 = core::Metres(2e-4);  // 3 pixels to the right, 2 up
  const io::ImageRaster out = undistorted(plane_image(), c, "a");
  EXPECT_EQ(out.values[out.at(50, 40)], 1000 + 100 * 53);
  EXPECT_EQ(out.values[out.at(50, 40) + 1], 1000 + 100 * 38);
  EXPECT_EQ(out.values[out.at(columns - 1, 40)], 0);  // beyond the image
}

TEST(Undistort, EachPixelIsWhereBrownSawIt) {
  CameraConfig c = camera();
  c.x0 = core::Metres(5e-5), c.y0 = core::Metres(-7e-5), c.k1 = -4e-4, c.k2 = 2e-6, c.p1 = 3e-5, c.p2 = -2e-5;
  const io::ImageRaster out = undistorted(plane_image(), c, "a");
  int inside = 0;
  for (int row = 0; row < rows; row += 3)
    for (int column = 0; column < columns; column += 3) {
      const double x = 0.1 * (column + 0.5) - 6.0, y = 4.0 - 0.1 * (row + 0.5), r2 = x * x + y * y;
      const double radial = c.k1 * r2 + c.k2 * r2 * r2;
      const double u = 0.05 + x + x * radial + c.p1 * (r2 + 2 * x * x) + 2 * c.p2 * x * y,
                   v = -0.07 + y + y * radial + c.p2 * (r2 + 2 * y * y) + 2 * c.p1 * x * y;
      const double pixel = (u + 6.0) / 0.1 - 0.5, line = (4.0 - v) / 0.1 - 0.5;
      if (pixel < 0 || line < 0 || pixel > columns - 1 || line > rows - 1) continue;
      ++inside;
      EXPECT_NEAR(out.values[out.at(column, row)], 1000 + 100 * pixel, 0.51);
      EXPECT_NEAR(out.values[out.at(column, row) + 1], 1000 + 100 * line, 0.51);
    }
  EXPECT_GT(inside, 1000);
}

TEST(Undistort, CamerasOfAFile) {
  const swath::test::TemporaryFolder folder;
  const auto file = folder.path() / "camera.toml";
  swath::test::write_bytes(file, undistorted_camera(camera()));
  const std::vector<CameraConfig> back = read_cameras(file);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].columns, columns);
  EXPECT_DOUBLE_EQ(back[0].f.value, 0.02);
  EXPECT_DOUBLE_EQ(back[0].pixel->value, 1e-4);
  EXPECT_NE(undistorted_camera(camera()).find("pixel = \"100 um\""), std::string::npos);
  CameraConfig quoted = camera();
  quoted.name = "\"left\" \\ 1";
  swath::test::write_bytes(file, undistorted_camera(quoted));
  EXPECT_EQ(read_cameras(file).at(0).name, quoted.name);
  swath::test::write_bytes(file, "crs = \"local\"\n");
  EXPECT_THROW(read_cameras(file), core::Error);
  CameraConfig other = camera();
  other.rows = 81;
  EXPECT_THROW(undistorted(plane_image(), other, "a"), core::Error);
}

}  // namespace
}  // namespace swath::calib
