// SPDX-License-Identifier: GPL-3.0-or-later
// Map coordinates of a square to a local Cartesian frame, without a call of PROJ for each point.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/block/imagery/oriented_images.h"
#include "core/area.h"

namespace swath::calib {

/// Nodes at multiples of 25 m by PROJ, with their vertical; bilinear between them: 0.02 mm off at most where heights are ellipsoidal (the
/// Earth's curvature over 25 m), and what a geoid bends over 25 m. The result depends on the point alone, not on the box.
class LocalPatch {
 public:
  /// `box` on the map, m. Throws core::Error where PROJ has no result.
  LocalPatch(const OrientedImages& images, const core::Box& box);

  /// A point of the box on the map, m, in the frame.
  Eigen::Vector3d operator()(const Eigen::Vector3d& map) const;

 private:
  static constexpr double spacing = 25.0;  // m
  struct Node {
    Eigen::Vector3d place, up;
  };
  double height_;
  std::int64_t i0_, j0_;
  int nx_, ny_;
  std::vector<Node> nodes_;
};

}  // namespace swath::calib
