// SPDX-License-Identifier: GPL-3.0-or-later
// Residuals of tie points at start values, and how they change where images are moved.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/block/image_block.h"

namespace swath::calib {

/// True for the points that control fixes; check points are tie points.
std::vector<char> points_of_control(const ImageBlock& block);

/// Rays of tie points.
std::vector<ImageRay> tie_rays(const ImageBlock& block);

/// mm; of a ray from behind the camera a large value. Points must be intersected.
double ray_residual(const ImageBlock& block, const ImageRay& ray);

/// Residuals of tie_rays() over the principal distance while images are moved one by one. A move costs what the points of that image cost,
/// whatever the size of the block.
class MovedResiduals {
 public:
  static constexpr double at_most = 0.2;  ///< what a residual counts in a mean: one strip's mistake shows up to this

  explicit MovedResiduals(const ImageBlock& block);
  void move(std::uint32_t image, const Eigen::Vector3d& position);
  const Eigen::Vector3d& position(std::uint32_t image) const { return block_.images[image].position; }

  /// Of tie_rays(), with the images where they are now.
  const std::vector<double>& all() const { return residuals_; }
  double mean() const;
  /// Of the rays of the points that any of these images sees.
  double mean_on(const std::vector<std::uint32_t>& images) const;

 private:
  void intersect(std::uint32_t point);

  ImageBlock block_;  ///< points intersected; without control
  std::vector<ImageRay> rays_;
  std::vector<std::optional<Eigen::Vector3d>> directions_;  ///< of the rays, local
  std::vector<double> residuals_;
  double sum_ = 0.0;                                 ///< of what the residuals count
  std::vector<Eigen::Vector3d> given_;               ///< positions of the points
  std::vector<std::vector<std::uint32_t>> seen_;     ///< points by image
  std::vector<std::vector<std::uint32_t>> rays_of_;  ///< by point
};

}  // namespace swath::calib
