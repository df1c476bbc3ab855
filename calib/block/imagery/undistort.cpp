// SPDX-License-Identifier: GPL-3.0-or-later
// Each pixel of the result is a direction of the ideal camera; its value is the image's where the camera saw that direction.
#include "calib/block/imagery/undistort.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/block/imagery/pixel_blend.h"
#include "calib/block/mark_plane.h"
#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/text/toml_text.h"
#include "io/text/value_file.h"

namespace swath::calib {
namespace {

struct CameraFile {
  std::vector<CameraConfig> cameras;
};
template <class V>
void describe(CameraFile& f, V& v) {
  v.tables("camera", f.cameras, "Cameras.");
}

/// Values at a place in pixels; nothing changes outside the centres of the outer pixels.
void sample(const io::ImageRaster& image, const Eigen::Vector2d& at, std::uint16_t* out) {
  constexpr double rounding = 1e-6, half = 0.5 - rounding;
  if (at.x() < half || at.y() < half || at.x() > image.columns - half || at.y() > image.rows - half) return;
  const PixelBlend blend(image, at.x(), at.y());
  for (int b = 0; b < image.bands; ++b) out[b] = static_cast<std::uint16_t>(std::lround(blend.of(static_cast<size_t>(b))));
}

}  // namespace

std::vector<CameraConfig> read_cameras(const std::filesystem::path& file) {
  CameraFile out;
  core::Value tree = io::read_value_file(file);
  if (core::Value* list = tree.find("camera"); list && list->is_array())  // those of a run say where the camera is on the carrier
    for (core::Value& camera : list->items())
      if (camera.is_object())
        std::erase_if(camera.members(), [](const auto& m) { return m.first == "lever_arm" || m.first == "technique"; });
  std::vector<core::Fault> faults;
  core::read_options(core::described(out), tree, "", faults);
  expect_distances(tree, faults);
  core::throw_if_any(faults);
  if (out.cameras.empty()) throw core::usage_error("no [[camera]]", file.string(), "`swath block` writes such a file: camera.toml");
  return out.cameras;
}

io::ImageRaster undistorted(const io::ImageRaster& image, const CameraConfig& config, const std::string& name) {
  pixel_side(config, name);
  if (image.columns != config.columns || image.rows != config.rows)
    throw core::Error("the image has " + std::to_string(image.columns) + " x " + std::to_string(image.rows) + " pixels, camera " +
                          config.name + " has " + std::to_string(config.columns) + " x " + std::to_string(config.rows),
                      name, "undistort the images as the camera took them, not turned and not resized");
  const BlockCamera camera = camera_of(config, name);
  const double side = 1e3 * config.pixel->value;
  io::ImageRaster out = image;
  std::fill(out.values.begin(), out.values.end(), std::uint16_t{0});
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.columns; ++column) {
      const Eigen::Vector3d direction((column + 0.5 - out.columns / 2.0) * side, (out.rows / 2.0 - row - 0.5) * side, -camera.value[0]);
      const auto seen = image_of(camera.value, camera.distortion, direction);
      if (!seen) continue;
      sample(image, in_pixels(*seen, config), &out.values[out.at(column, row)]);
    }
  return out;
}

std::string undistorted_camera(const CameraConfig& c) {
  const auto number = [](double v) {
    char text[40];
    std::snprintf(text, sizeof text, "%.12g", v);  // 60 um are 6e-5 m, times 1e6 not 60 again
    return std::string(text);
  };
  return "\n[[camera]]\nname = " + io::toml_scalar(c.name) + "\nf = \"" + number(1e3 * c.f.value) +
         " mm\"\ncolumns = " + std::to_string(c.columns) + "\nrows = " + std::to_string(c.rows) + "\npixel = \"" +
         number(1e6 * c.pixel->value) + " um\"\n";
}

}  // namespace swath::calib
