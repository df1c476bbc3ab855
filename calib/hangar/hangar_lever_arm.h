// SPDX-License-Identifier: GPL-3.0-or-later
// From points of an aircraft in a hangar to lever arms in its body frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geo/frames.h"

namespace swath::calib {

/// Points in the hangar's frame (x, y level, z up, right-handed; heading counts from y clockwise) with their joint covariance.
struct HangarPoints {
  std::vector<Eigen::Vector3d> position;  ///< m
  Eigen::MatrixXd covariance;             ///< 3 per point, m^2
};

/// How the body stands in the hangar, with what its errors come from: own errors of the three angles, and the points' errors.
struct BodyAxes {
  core::Attitude attitude;                          ///< body to north (y), east (x), down of the hangar
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< own sigmas of roll, pitch, heading, rad
  Eigen::RowVectorXd heading_by_points;             ///< 3 per point, rad/m; all 0 for a stated heading
};

/// Axes with a stated heading.
BodyAxes stated_axes(const core::Attitude& attitude, const Eigen::Vector3d& sigma, size_t points);
/// Axes whose heading is that of the line from the mean of the marks `aft` to the mean of the marks `fore`, plus `offset`; roll and pitch
/// as stated. Both lists are not empty and the marks' means are apart in the level plane.
BodyAxes axes_of_marks(const HangarPoints& points, const std::vector<size_t>& aft, const std::vector<size_t>& fore, double offset,
                       const core::Attitude& level, const Eigen::Vector3d& sigma);

/// A point of the aircraft as surveyed: a mark, and the way from the mark to the point meant (IMU centre, phase centre, origin of the
/// beam).
struct BodyPoint {
  size_t mark = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< body, m
  double offset_sigma = 0.0;                         ///< of each component, m
};

struct BodyVector {
  Eigen::Vector3d value;       ///< body: forward, right, down, m
  Eigen::Matrix3d covariance;  ///< m^2
  Eigen::MatrixXd by_points;   ///< derivatives, 3 x 3 per point, the heading's dependence on the marks included
  Eigen::Matrix3d by_angles;   ///< derivatives by roll, pitch, heading, m/rad
};
/// The way from one point to another in body axes: R' (to - from) + offset_to - offset_from. Errors that both points share (stations, axes)
/// enter once.
BodyVector body_vector(const HangarPoints& points, const BodyPoint& from, const BodyPoint& to, const BodyAxes& axes);

}  // namespace swath::calib
