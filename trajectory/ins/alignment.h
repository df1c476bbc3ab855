// SPDX-License-Identifier: GPL-3.0-or-later
// The attitude to begin with, from standstill or from motion.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/records/imu_spec.h"
#include "trajectory/ins/imu_walk.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// Attitude at one instant, with the covariance of its rotation error psi (ecef axes, rad^2).
struct Alignment {
  double time = 0.0;
  Eigen::Matrix3d ecef_R_body = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< rad/s, as far as a standstill shows it
  std::string method;
  double worst_sigma() const;  ///< of the rotation about the least known axis, rad
};

/// Stretches of at least 2 s on which the body stands still: the fixes do not move beyond their sigmas, gyros and accelerometers are
/// quiet (0.5 deg/s and 0.3 m/s^2 within a second).
std::vector<Span> find_standstills(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec);

/// Levelling and gyrocompassing: the mean specific force points up, the mean rate is the Earth's. Covariance from the sensors' biases and
/// random walks; the heading's is large where the gyros cannot feel the Earth turn.
Alignment align_still(const ImuPath& path, const Span& stretch, const Eigen::Vector3d& ecef, const core::ImuErrorModel& spec);

/// Attitude from fixes in motion (after Wu and Pan 2013, "velocity/position integration formula", here with second differences of
/// positions so that neither start position nor velocity is needed): the rotation that turns the gyro-integrated second differences of
/// the twice integrated specific force, lever arm included, into those of the fixes less gravitation, all in the inertial frame of the
/// window's beginning; Wahba's problem, solved by the singular value decomposition. Track as heading is added with a sigma of 15 deg where
/// the body moves. Of windows of 40 s within the first 30 min the first that gives 1 deg, or else the best.
/// Nothing where no window holds enough fixes.
std::optional<Alignment> align_moving(const ImuPath& path, const core::GnssData& gnss, const Eigen::Vector3d& lever_arm,
                                      const core::ImuErrorModel& spec, const Eigen::Vector3d& gyro_bias);

/// The attitude carried to another instant by the gyros; its covariance grows by their biases and walks.
Alignment carried(const Alignment& from, double time, const ImuPath& path, const core::ImuErrorModel& spec);

}  // namespace swath::trajectory
