// SPDX-License-Identifier: GPL-3.0-or-later
// Start values of a block: poses from stations and the direction of flight or from observed attitudes, points by intersection.
#pragma once

#include <optional>

#include "calib/block/image_block.h"

namespace swath::calib {

/// Sets camera_R_local of an image from an attitude of the body and its camera's mounting.
void set_attitude(ImageBlock& block, std::uint32_t image, const Eigen::Matrix3d& local_R_body);

/// Poses of all images from stations: the antenna's lever arm is taken off, attitudes are those observed or else level, with the heading
/// of the strip at its neighbours in time. Throws core::Error: an image without station, a strip of one image without attitude.
void start_poses(ImageBlock& block);

/// Turns images that started level until their rays meet those of the others, their perspective centres held: rounds of points by
/// intersection (on level ground where their rays meet behind an image or far off) and of each
/// image's attitude from its points; then points by intersection.
void turn_level_images(ImageBlock& block);

/// The point whose sum of squared distances from rays is least.
class RayIntersection {
 public:
  /// `direction`: of length 1.
  void add(const Eigen::Vector3d& from, const Eigen::Vector3d& direction);
  int rays() const { return rays_; }
  /// None where the rays are parallel.
  std::optional<Eigen::Vector3d> point() const;

 private:
  Eigen::Matrix3d N_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
  int rays_ = 0;
};

/// Points by intersection of their rays, the sum of squared distances least; control coordinates that are known replace those found.
/// Points with one ray are left as they are. Returns the points whose rays are parallel.
size_t intersect_points(ImageBlock& block);

}  // namespace swath::calib
