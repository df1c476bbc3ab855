// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/image_choice.h"

#include <algorithm>
#include <cmath>

#include "calib/block/mark_plane.h"

namespace swath::calib {

ImageChoice::ImageChoice(const OrientedImages& images, const core::Box& box, double lowest, const SightOptions& o)
    : images_(images), steepest_(std::tan(o.off_nadir.value)) {
  for (std::uint32_t i = 0; i < images.images.size(); ++i) {
    const OrientedImage& image = images.images[i];
    const double dx = std::max({box.x0 - image.map.x(), image.map.x() - box.x1, 0.0}),
                 dy = std::max({box.y0 - image.map.y(), image.map.y() - box.y1, 0.0}), height = image.map.z() - lowest;
    if (height > 0.0 && std::hypot(dx, dy) <= height * std::min(image.steepest, steepest_)) near_.push_back(i);
  }
}

void ImageChoice::rank(const Eigen::Vector3d& map) {
  ranked_.clear();
  for (const std::uint32_t i : near_) {
    const Eigen::Vector3d way = images_.images[i].map - map;
    if (!(way.z() > 0.0)) continue;
    const double slope = way.head<2>().norm() / way.z();
    if (slope <= steepest_ && slope <= images_.images[i].steepest) ranked_.emplace_back(slope, i);
  }
}

std::optional<Eigen::Vector2d> ImageChoice::pixel_of(std::uint32_t image, const Eigen::Vector3d& local) const {
  const OrientedImage& i = images_.images[image];
  const BlockCamera& camera = images_.cameras[i.camera];
  const auto plane = image_of(camera.value, camera.distortion, i.camera_R_local * (local - i.local));
  if (!plane) return {};
  const CameraConfig& config = images_.configs[i.camera];
  const Eigen::Vector2d pixel = in_pixels(*plane, config);
  if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= config.columns && pixel.y() <= config.rows)) return {};
  constexpr int margin = 2;  // pixels: neighbours of a rim are mixed with it
  if (images_.is_rim(i.camera, pixel, margin)) return {};
  return pixel;
}

}  // namespace swath::calib
