// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/mark_plane.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;

CameraConfig pixels() {
  CameraConfig c;
  c.columns = 4000, c.rows = 3000, c.pixel = core::Metres(5e-6);
  return c;
}

io::ImageData data(io::ImageUnit unit, io::ImageY y, io::ImageOrigin origin) {
  io::ImageData d;
  d.unit = unit, d.y = y, d.origin = origin;
  return d;
}

Vector2d plane(io::ImageUnit unit, io::ImageY y, io::ImageOrigin origin, double a, double b) {
  return on_plane(data(unit, y, origin), {0, 0, a, b, 0}, pixels());
}

TEST(MarkPlane, TheSamePointInEveryConvention) {
  using U = io::ImageUnit;
  using Y = io::ImageY;
  using O = io::ImageOrigin;
  const Vector2d p(1.0, -2.0);  // mm: 200 pixels to the right of the middle, 400 below it
  EXPECT_LT((plane(U::mm, Y::up, O::middle, 1.0, -2.0) - p).norm(), 1e-12);
  EXPECT_LT((plane(U::um, Y::down, O::middle, 1000.0, 2000.0) - p).norm(), 1e-12);
  EXPECT_LT((plane(U::pixel, Y::down, O::corner, 2200.0, 1900.0) - p).norm(), 1e-12);
  EXPECT_LT((plane(U::pixel, Y::down, O::pixel_centre, 2199.5, 1899.5) - p).norm(), 1e-12);
  EXPECT_LT((plane(U::pixel, Y::up, O::corner, 2200.0, 1100.0) - p).norm(), 1e-12);
  EXPECT_LT((in_pixels(p, pixels()) - Vector2d(2200.0, 1900.0)).norm(), 1e-9);
  CameraConfig bare;
  EXPECT_THROW(on_plane(data(U::pixel, Y::down, O::corner), {0, 0, 1, 1, 0}, bare), core::Error);
}

TEST(MarkPlane, ColmapsCameraSeesTheSamePixel) {
  BlockCamera c;
  c.value << 16.0, 0.02, -0.03, 3e-4, -2e-6, 1e-9, 4e-5, -5e-5, 0, 0;
  const auto k = pixel_camera(c, pixels());
  ASSERT_TRUE(k);
  for (const auto& d : {Eigen::Vector3d(0.1, 0.2, -1.0), {-0.4, 0.3, -1.0}, {0.5, -0.35, -1.0}}) {
    const Vector2d here = in_pixels(*image_of(c.value, DistortionAt::ideal, d), pixels());
    // OpenCV: y down, z forward.
    const double u = d.x() / -d.z(), v = -d.y() / -d.z(), r2 = u * u + v * v;
    const double radial = 1.0 + r2 * (k->k1 + r2 * (k->k2 + r2 * k->k3));
    const Vector2d there(k->cx + k->fx * (u * radial + 2.0 * k->p1 * u * v + k->p2 * (r2 + 2.0 * u * u)),
                         k->cy + k->fy * (v * radial + k->p1 * (r2 + 2.0 * v * v) + 2.0 * k->p2 * u * v));
    EXPECT_LT((here - there).norm(), 1e-9);
  }
  c.value[8] = 1e-4;
  EXPECT_FALSE(pixel_camera(c, pixels()));
  c.value[8] = 0.0, c.distortion = DistortionAt::measured;
  EXPECT_FALSE(pixel_camera(c, pixels()));
}

}  // namespace
}  // namespace swath::calib
