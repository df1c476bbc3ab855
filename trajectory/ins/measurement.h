// SPDX-License-Identifier: GPL-3.0-or-later
// What the filter expects to measure, and how that depends on its errors.
#pragma once

#include "trajectory/ins/error_state.h"

namespace swath::trajectory {

/// A predicted measurement with its derivatives by the error state.
template <int Rows>
struct Prediction {
  Eigen::Matrix<double, Rows, 1> value;
  Eigen::Matrix<double, Rows, Eigen::Dynamic, 0, Rows, most_states> design;
};

/// The antenna's velocity relative to the Earth, ecef axes, m/s; `rate`: body against inertial space, body axes, rad/s.
Eigen::Vector3d antenna_velocity(const Estimate& e, const Eigen::Vector3d& rate);

/// A fix of the antenna, ecef, m: position + turned lever arm + spread * fix error + latency * velocity.
/// `spread`: takes the fix error's units to ecef metres. The latency's effect on the velocity itself is left out (1 ms at 1 m/s^2: 1 um).
Prediction<3> predict_fix(const Layout& layout, const Estimate& e, const Eigen::Vector3d& rate, const Eigen::Matrix3d& spread);

/// The antenna's velocity; `rate` moves with the gyro bias.
Prediction<3> predict_velocity(const Layout& layout, const Estimate& e, const Eigen::Vector3d& rate);

/// The wheels' velocity across and down (m/s), about the vehicle's own forward axis: nothing, for wheels that do not slip.
///   across = v_y - azimuth v_x, down = v_z + elevation v_x, v = body_R_ecef velocity + rate x wheel.
/// `forward` receives v_x.
Prediction<2> predict_wheels(const Layout& layout, const Estimate& e, const Eigen::Vector3d& rate, const Eigen::Vector3d& wheel,
                             double& forward);

}  // namespace swath::trajectory
