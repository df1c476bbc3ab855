// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that is level as far as its points can show: water.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace swath::filters {

struct LevelPlane {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of the points, m
  double east = 0, north = 0;                        ///< rise / run
  double sigma = 0;                                  ///< m, standard deviation of the points about their plane, at least 1 cm
  double at(double x, double y) const { return centre.z() + east * (x - centre.x()) + north * (y - centre.y()); }
};

/// Least squares through the points (m), judged along both axes of their spread: nothing where a slope is larger than `steepest` (rise /
/// run) by more than twice its standard deviation, or that along the longer axis is uncertain by more than `most_uncertain`. The slope
/// given has a prior of mean 0 and standard deviation 0.001, that of rivers: where the points say little, the plane is level. Reorders the
/// points and does not depend on their order.
std::optional<LevelPlane> level_plane(std::vector<Eigen::Vector3d>& points, double steepest, double most_uncertain);

}  // namespace swath::filters
