// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>

#include "core/time.h"
#include "core/value.h"
#include "simulate/flight.h"
#include "simulate/options.h"

namespace swath::simulate {

/// Angular rate of `body` against inertial space (rad/s) and specific force (m/s^2), both in `body`.
struct Inertial {
  Eigen::Vector3d rate, force;
};
/// Earth rate, transport rate, Coriolis and normal gravity are taken out of the motion exactly (Savage 2000, ch. 4; gravity along the
/// ellipsoid's normal at the point).
Inertial inertial_of(const Motion& motion);

/// Increments over [t - step, t]: integrals of rate and specific force along the body's turning axes (no coning, no sculling terms).
struct Increments {
  Eigen::Vector3d angle, velocity;
};
Increments increments_of(const Flight& flight, double t, double step);

/// Errors of an IMU: constant biases and scale factors drawn once, white noise per increment.
struct ImuErrors {
  std::array<double, 3> gyro_bias{}, accelerometer_bias{};    ///< rad/s, m/s^2
  std::array<double, 3> gyro_scale{}, accelerometer_scale{};  ///< 1
  double angle_walk = 0.0, velocity_walk = 0.0;               ///< rad/sqrt(s), m/s/sqrt(s)
};
ImuErrors draw_imu_errors(ImuGrade grade, std::int64_t seed);
core::Value value_of(const ImuErrors& errors);

constexpr double imu_step = 0.005, gnss_step = 0.2;  // s

/// imu.csv: seconds of week (counting on past its end), increments over the 5 ms that end there, forward-right-down.
void write_imu(const std::filesystem::path& file, const Flight& flight, core::GpsTime start, const ImuErrors& errors, std::int64_t seed);

/// gnss.csv: antenna positions with their covariance in ECEF. Errors: white, of the sigmas stated for each fix.
void write_gnss(const std::filesystem::path& file, const Flight& flight, core::GpsTime start, const std::array<core::Metres, 3>& lever_arm,
                bool noise_free, std::int64_t seed);

}  // namespace swath::simulate
