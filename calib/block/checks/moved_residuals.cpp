// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/moved_residuals.h"

#include <algorithm>

#include "calib/block/block_start.h"

namespace swath::calib {

std::vector<char> points_of_control(const ImageBlock& block) {
  std::vector<char> out(block.points.size(), 0);
  for (const BlockControl& c : block.control)
    if (!c.check) out[c.point] = 1;
  return out;
}

std::vector<ImageRay> tie_rays(const ImageBlock& block) {
  const std::vector<char> is_control = points_of_control(block);
  std::vector<ImageRay> out;
  for (const ImageRay& r : block.rays)
    if (!is_control[r.point]) out.push_back(r);
  return out;
}

double ray_residual(const ImageBlock& block, const ImageRay& r) {
  const BlockImage& i = block.images[r.image];
  const BlockCamera& camera = block.cameras[i.camera];
  const auto seen = image_of(camera.value, camera.distortion, i.camera_R_local * (block.points[r.point].position - i.position));
  return seen ? (*seen - Eigen::Vector2d(r.x, r.y)).norm() : 10.0 * camera.value[0];
}

MovedResiduals::MovedResiduals(const ImageBlock& block)
    : rays_(tie_rays(block)), seen_(block.images.size()), rays_of_(block.points.size()) {
  block_.cameras = block.cameras;
  block_.images = block.images;
  block_.points = block.points;
  for (const BlockPoint& p : block_.points) given_.push_back(p.position);
  for (std::uint32_t k = 0; k < rays_.size(); ++k) {
    const ImageRay& r = rays_[k];
    const BlockImage& image = block_.images[r.image];
    const BlockCamera& camera = block_.cameras[image.camera];
    const auto d = direction_of(camera.value, camera.distortion, {r.x, r.y});
    directions_.push_back(d ? std::optional((image.camera_R_local.transpose() * *d).normalized()) : std::nullopt);
    seen_[r.image].push_back(r.point);
    rays_of_[r.point].push_back(k);
  }
  residuals_.resize(rays_.size(), 0.0);
  for (std::uint32_t p = 0; p < rays_of_.size(); ++p) intersect(p);
}

void MovedResiduals::intersect(std::uint32_t point) {
  RayIntersection sum;
  for (const std::uint32_t k : rays_of_[point])
    if (directions_[k]) sum.add(block_.images[rays_[k].image].position, *directions_[k]);
  block_.points[point].position = (sum.rays() < 2 ? std::nullopt : sum.point()).value_or(given_[point]);
  for (const std::uint32_t k : rays_of_[point]) {
    const double now = ray_residual(block_, rays_[k]) / block_.cameras[block_.images[rays_[k].image].camera].value[0];
    sum_ += std::min(at_most, now) - std::min(at_most, residuals_[k]);
    residuals_[k] = now;
  }
}

void MovedResiduals::move(std::uint32_t image, const Eigen::Vector3d& position) {
  block_.images[image].position = position;
  for (const std::uint32_t p : seen_[image]) intersect(p);
}

double MovedResiduals::mean() const { return sum_ / std::max(1.0, static_cast<double>(residuals_.size())); }

double MovedResiduals::mean_on(const std::vector<std::uint32_t>& images) const {
  std::vector<char> wanted(rays_of_.size(), 0);
  for (const std::uint32_t i : images)
    for (const std::uint32_t p : seen_[i]) wanted[p] = 1;
  double sum = 0.0, count = 0.0;
  for (size_t k = 0; k < rays_.size(); ++k)
    if (wanted[rays_[k].point]) sum += std::min(at_most, residuals_[k]), count += 1.0;
  return sum / std::max(1.0, count);
}

}  // namespace swath::calib
