// SPDX-License-Identifier: GPL-3.0-or-later
// A flat roof as a calibration target.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "trajectory/fix_window.h"

namespace swath::calib {

/// A flat roof with upright walls. Local frame: east, north, up; its origin near the roof's centre.
struct RoofTarget {
  std::string name;
  trajectory::LocalFrame frame;
  std::vector<Eigen::Vector2d> corners;             ///< east, north, m; counter-clockwise seen from above, three or more, convex
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();  ///< up = plane . (1, east, north), m
  double sigma_h = 0.02, sigma_v = 0.02;            ///< of each corner: east and north each, height; m
  bool surveyed = true;

  double up(const Eigen::Vector2d& p) const { return plane[0] + plane[1] * p.x() + plane[2] * p.y(); }
  bool holds(const Eigen::Vector2d& p) const;
  Eigen::Vector2d centre() const;  ///< mean of the corners
  size_t sides() const { return corners.size(); }
  /// Side k, from corner k to corner k + 1.
  struct Side {
    Eigen::Vector2d middle, along, outward;  ///< east, north, m; unit vectors
    double length;                           ///< m
  };
  Side side(size_t k) const;
  double area() const;  ///< m^2, seen from above
};
/// From corners in ecef, m, in their order around (either sense). Throws core::Error for fewer than three, or where they are not convex.
RoofTarget roof_target(const std::string& name, const std::vector<Eigen::Vector3d>& corners, double sigma_h, double sigma_v);

}  // namespace swath::calib
