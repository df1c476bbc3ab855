// SPDX-License-Identifier: GPL-3.0-or-later
// The error state of the INS/GNSS filter: which errors it holds, how they grow over an interval, how they correct the estimate.
//
//   position, velocity: true minus estimated, ecef, m and m/s
//   attitude: psi with ecef_R_body(true) = exp(psi) ecef_R_body(estimated), ecef axes, rad
//   gyro and accelerometer bias, scale: measured = (1 + scale) true + bias; body, rad/s, m/s^2, 1
//   lever arm: IMU centre to antenna, body, m
//   fix error: time-correlated part of the GNSS error, north east down, in units of its standard deviation
//   latency: true minus stated time of the fixes, s
//   track: azimuth and elevation of a vehicle's forward axis in body, rad
#pragma once

#include <Eigen/Core>

#include "core/records/imu_spec.h"
#include "trajectory/ins/imu_walk.h"
#include "trajectory/ins/strapdown.h"

namespace swath::trajectory {

constexpr int most_states = 30;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_states, most_states>;
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_states, 1>;

/// First row of each error; -1 where the filter does not hold it.
struct Layout {
  static constexpr int position = 0, velocity = 3, attitude = 6, gyro_bias = 9, force_bias = 12;
  int gyro_scale = -1, force_scale = -1, lever = -1, fix = -1, latency = -1, track = -1;
  int size = 15;

  Layout() = default;
  Layout(bool scales, bool lever_arm, bool correlated_fixes, bool fix_latency, bool vehicle);
};

/// Everything the filter estimates.
struct Estimate {
  NavState nav;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), force_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero(), force_scale = Eigen::Vector3d::Zero();
  Eigen::Vector3d lever = Eigen::Vector3d::Zero(), fix = Eigen::Vector3d::Zero();
  double latency = 0.0;
  Eigen::Vector2d track = Eigen::Vector2d::Zero();

  /// Adds an error vector.
  void correct(const Layout& layout, const StateVector& error);
  /// The error vector that leads from `from` to this.
  StateVector minus(const Estimate& from, const Layout& layout) const;
  /// The increment without the estimated sensor errors.
  Increment corrected(const Increment& measured) const;
};

/// Noise that drives the errors: power spectral densities.
struct ProcessNoise {
  double angle = 0.0, velocity = 0.0;          ///< white noise of rate and force: rad^2/s, m^2/s^3
  double gyro_drift = 0.0, force_drift = 0.0;  ///< random walk of the biases: rad^2/s^3, m^2/s^5
  double fix_time = 120.0;                     ///< correlation time of the fixes' correlated part, s

  /// Drift as a random walk with the slope of the Gauss-Markov process at short lags, q = 2 sigma^2 / tau: its stationary part is held by
  /// the constant's sigma. Over times beyond tau this is on the safe side.
  static ProcessNoise of(const core::ImuErrorModel& model, double fix_time);
};

/// Carries the estimate over an interval at the IMU's rate and collects the transition matrix of its errors:
///   d psi/dt = -w_ie x psi + C dw,  d dv/dt = -(C f) x psi + C df - 2 w_ie x dv + G dr,  d dr/dt = dv
/// (Groves 2013, 14.3, in these signs); products of the Earth's rate with sensor errors within one interval are left out (7e-5 of them).
class Propagation {
 public:
  Propagation(const Layout& layout, const Estimate& at) : layout_(layout), estimate_(at) {}
  void add(const Increment& measured);
  const NavState& nav() const { return estimate_.nav; }
  double elapsed() const { return elapsed_; }

  StateMatrix transition(const ProcessNoise& noise) const;
  /// Variances gained over the interval, by the diagonal; `bridged`: what parts of it without records add.
  StateVector gained(const ProcessNoise& noise, const Bridging& bridged = {}) const;

 private:
  Layout layout_;
  Estimate estimate_;
  double elapsed_ = 0.0;
  // Attitude, velocity and position by gyro bias and scale; velocity and position by accelerometer bias and scale and by attitude.
  Eigen::Matrix3d psi_bias_ = Eigen::Matrix3d::Zero(), psi_scale_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_psi_ = Eigen::Matrix3d::Zero(), v_gyro_bias_ = Eigen::Matrix3d::Zero(), v_gyro_scale_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_bias_ = Eigen::Matrix3d::Zero(), v_scale_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d r_psi_ = Eigen::Matrix3d::Zero(), r_gyro_bias_ = Eigen::Matrix3d::Zero(), r_gyro_scale_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d r_bias_ = Eigen::Matrix3d::Zero(), r_scale_ = Eigen::Matrix3d::Zero();
};

}  // namespace swath::trajectory
