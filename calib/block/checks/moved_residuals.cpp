// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/moved_residuals.h"

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

MovedResiduals::MovedResiduals(const ImageBlock& block) : rays_(tie_rays(block)), seen_(block.images.size()) {
  block_.cameras = block.cameras;
  block_.images = block.images;
  block_.points = block.points;
  block_.rays = rays_;
  for (const BlockPoint& p : block_.points) given_.push_back(p.position);
  intersect_points(block_);
  for (const BlockPoint& p : block_.points) intersected_.push_back(p.position);
  for (const ImageRay& r : rays_) {
    residuals_.push_back(residual(r));
    seen_[r.image].push_back(r.point);
  }
}

double MovedResiduals::residual(const ImageRay& r) const {
  return ray_residual(block_, r) / block_.cameras[block_.images[r.image].camera].value[0];
}

std::vector<double> MovedResiduals::at(const ImageBlock& moved) {
  std::vector<std::pair<size_t, Eigen::Vector3d>> images;  // those moved, and where they were
  std::vector<char> again(block_.points.size(), 0);
  for (size_t i = 0; i < block_.images.size(); ++i) {
    Eigen::Vector3d& position = block_.images[i].position;
    if (position == moved.images[i].position) continue;
    images.emplace_back(i, position);
    position = moved.images[i].position;
    for (const std::uint32_t p : seen_[i]) again[p] = 1;
  }
  block_.rays.clear();
  for (const ImageRay& r : rays_)
    if (again[r.point]) block_.rays.push_back(r);
  for (size_t p = 0; p < again.size(); ++p)
    if (again[p]) block_.points[p].position = given_[p];
  intersect_points(block_);
  std::vector<double> out = residuals_;
  for (size_t k = 0; k < rays_.size(); ++k)
    if (again[rays_[k].point]) out[k] = residual(rays_[k]);
  for (const auto& [image, position] : images) block_.images[image].position = position;
  for (size_t p = 0; p < again.size(); ++p)
    if (again[p]) block_.points[p].position = intersected_[p];
  return out;
}

}  // namespace swath::calib
