// SPDX-License-Identifier: GPL-3.0-or-later
// OpenCV's distortion is of the normalised ideal point, y down; with x = f u, y = -f v Brown's values are k1 / f^2, k2 / f^4, k3 / f^6,
// p1 = p2' / f and p2 = -p1' / f of its k1, k2, k3, p1', p2'.
#include "calib/block/mark_plane.h"

#include <cmath>

#include "core/error.h"

namespace swath::calib {

namespace {
constexpr double plane_unit = 1e3;  // mm in a metre

void expect_pixels(const CameraConfig& camera, const std::string& file) {
  if (!camera.pixel || camera.columns <= 0 || camera.rows <= 0)
    throw core::Error("image points or their sigma are in pixels, and camera " + camera.name + " does not state columns, rows and pixel",
                      file, "add columns = ..., rows = ..., pixel = \"5 um\" to [[camera]]");
}
}  // namespace

double pixel_side(const CameraConfig& camera, const std::string& file) {
  expect_pixels(camera, file);
  return camera.pixel->value;
}

Eigen::Vector2d on_plane(const io::ImageData& data, const io::ImageMark& m, const CameraConfig& camera) {
  Eigen::Vector2d p(m.x, m.y);
  if (data.unit == io::ImageUnit::um) p *= 1e-3;
  const bool pixels = data.unit == io::ImageUnit::pixel;
  if (pixels || data.origin != io::ImageOrigin::middle) expect_pixels(camera, data.file.string());
  const double side = camera.pixel ? plane_unit * camera.pixel->value : 1.0;
  if (pixels) p *= side;
  if (data.origin != io::ImageOrigin::middle) {
    const double shift = data.origin == io::ImageOrigin::pixel_centre ? 0.5 : 0.0;
    p.x() += (shift - camera.columns / 2.0) * side;
    // From the upper left corner down, or from the lower left one up.
    p.y() += (shift - camera.rows / 2.0) * side;
  }
  if (data.y == io::ImageY::down) p.y() = -p.y();
  return p;
}

Eigen::Vector2d in_pixels(const Eigen::Vector2d& plane, const CameraConfig& camera) {
  const double side = plane_unit * camera.pixel->value;
  return {plane.x() / side + camera.columns / 2.0, camera.rows / 2.0 - plane.y() / side};
}

std::optional<io::FileCamera> pixel_camera(const BlockCamera& camera, const CameraConfig& config) {
  const CameraVector& v = camera.value;
  const bool distorted = !v.tail<7>().isZero(0.0);
  if (v[8] != 0.0 || v[9] != 0.0 || (distorted && camera.distortion != DistortionAt::ideal)) return {};
  io::FileCamera out;
  out.name = camera.name;
  out.columns = config.columns;
  out.rows = config.rows;
  const double f = v[0], side = plane_unit * config.pixel->value;
  out.fx = out.fy = f / side;
  const Eigen::Vector2d principal = in_pixels({v[1], v[2]}, config);
  out.cx = principal.x(), out.cy = principal.y();
  out.k1 = v[3] * f * f, out.k2 = v[4] * std::pow(f, 4), out.k3 = v[5] * std::pow(f, 6);
  out.p2 = v[6] * f, out.p1 = -v[7] * f;
  return out;
}

}  // namespace swath::calib
