// SPDX-License-Identifier: GPL-3.0-or-later
// Residuals of tie points at start values, and how they change where images are moved.
#pragma once

#include <vector>

#include "calib/block/image_block.h"

namespace swath::calib {

/// True for the points that control fixes; check points are tie points.
std::vector<char> points_of_control(const ImageBlock& block);

/// Rays of tie points.
std::vector<ImageRay> tie_rays(const ImageBlock& block);

/// mm; of a ray from behind the camera a large value. Points must be intersected.
double ray_residual(const ImageBlock& block, const ImageRay& ray);

/// Residuals of tie_rays() over the principal distance, of one block with images at one place and another. Only points that a moved image
/// sees are intersected again: a block is not copied for each trial.
class MovedResiduals {
 public:
  explicit MovedResiduals(const ImageBlock& block);
  /// As the block was given.
  const std::vector<double>& stated() const { return residuals_; }
  /// `moved`: the block as it was given, but for positions of images.
  std::vector<double> at(const ImageBlock& moved);

 private:
  double residual(const ImageRay& ray) const;

  ImageBlock block_;  ///< points intersected; without control
  std::vector<ImageRay> rays_;
  std::vector<double> residuals_;
  std::vector<Eigen::Vector3d> given_, intersected_;  ///< positions of the points
  std::vector<std::vector<std::uint32_t>> seen_;      ///< points by image
};

}  // namespace swath::calib
