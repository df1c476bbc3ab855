// SPDX-License-Identifier: GPL-3.0-or-later
// Lever arms under tilt, with the signs of the project: body is forward, right, down.
#pragma once

#include <Eigen/Core>

#include "core/geo/frames.h"

namespace swath::calib {

/// The point whose antenna stands at `antenna_ned`, `lever` (body, m) being the way from the point to the antenna:
/// point = antenna - ned_R_body lever. All in one north, east, down frame, m.
Eigen::Vector3d point_from_antenna(const Eigen::Vector3d& antenna_ned, const core::Attitude& attitude, const Eigen::Vector3d& lever);

/// What a tilt moves the far end of a lever arm by, against level flight: |(R - 1) lever|, m.
double tilt_shift(const Eigen::Vector3d& lever, const core::Attitude& tilt);

/// Attitude of a body that photogrammetry states as omega about x (forward), then phi about y (left), z up: R = Rx(omega) Ry(phi), rad.
/// Heading comes out as the forward axis' own, a product of omega and phi.
core::Attitude attitude_of_tilt(double omega, double phi);

/// A vertical lever arm of length `up` under omega and phi: x forward, y left, z up, m (Jubanski et al., eq 3).
Eigen::Vector3d vertical_lever_arm(double up, double omega, double phi);

/// A lever arm's far end under tilt against its near end, in level axes (forward, right, down), m.
struct TiltedArm {
  Eigen::Vector3d end = Eigen::Vector3d::Zero();    ///< with the tilt
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< `end` less that without it
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< of `end`: of the arm and of the tilt
};
/// Jubanski et al., eq 3, for any arm. `covariance`: of the arm, body, m^2; `tilt_sigma`: of roll and of pitch, rad.
TiltedArm tilted(const Eigen::Vector3d& lever, const Eigen::Matrix3d& covariance, const core::Attitude& tilt, double tilt_sigma);

}  // namespace swath::calib
