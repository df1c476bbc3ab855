// SPDX-License-Identifier: GPL-3.0-or-later
// A station from measured distances to known targets, with its mirror image looked for.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

namespace swath::calib {

/// A distance from the unknown station to a known point.
struct TargetDistance {
  Eigen::Vector3d target;  ///< m
  double distance;         ///< m, above 0
  double sigma;            ///< m, above 0
};

enum class ResectionState {
  solved,
  too_few,  ///< fewer than three distances
  in_line,  ///< the targets lie in one line: the station may be anywhere on a circle around it
  weak,     ///< the station lies nearly in the plane of its targets: its distance from the plane is hardly determined, and no sigma is true
  two_fit,  ///< the station and its mirror image fit the distances equally well, and no start value says which
  not_found,  ///< no position fits
};

struct Resection {
  ResectionState state = ResectionState::not_found;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();                 ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();               ///< by the stated sigmas, m^2
  double variance_factor = std::numeric_limits<double>::quiet_NaN();  ///< sigma0^2; NaN without redundancy
  int redundancy = 0;                                                 ///< distances less three
  std::vector<double> residual;                                       ///< observed - adjusted, m
  std::vector<double> w;  ///< residuals by their own sigma (Baarda); 0 where nothing checks the distance
  /// A second position that the distances lead to, and its sum of squares over `redundancy` (1 where that is 0).
  std::optional<Eigen::Vector3d> mirror;
  double mirror_variance_factor = 0.0;
  bool decided_by_start = false;     ///< both fit equally well; the one nearer to the start value was taken
  bool start_led_to_mirror = false;  ///< from the start value alone the mirror would have been found
  /// Factor on the distances that makes them fit, from six distances on; 1 for distances in the targets' unit. NaN where it is not known.
  double scale = std::numeric_limits<double>::quiet_NaN();
};

/// Parametric adjustment of a station from distances (Jubanski et al., eq 9), from computed start values on both sides of the targets'
/// plane and from `start` where there is one. The position with the least sum of squares is taken; where two fit equally well, the one
/// nearer to `start`.
Resection resect(const std::vector<TargetDistance>& distances, const std::optional<Eigen::Vector3d>& start = {});

/// By how many of its sigmas a position may move by what distances bend over one sigma of its least known direction. Distances show the
/// square of a height h over the plane of their targets; with s its sigma this is s / (4 h^2): sign and sigma of a height are known from
/// three s on.
constexpr double largest_bend = 1.0 / 12.0;

/// Distance to a target as the adjustment computes it, and its derivatives by the station.
struct DistanceModel {
  double distance;
  Eigen::RowVector3d by_station;
};
DistanceModel distance_model(const Eigen::Vector3d& station, const Eigen::Vector3d& target);

}  // namespace swath::calib
