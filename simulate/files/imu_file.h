// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>

#include "core/config/value.h"
#include "core/records/imu_spec.h"
#include "core/time.h"
#include "io/survey/navigation.h"
#include "simulate/flight.h"
#include "simulate/navigation_options.h"
#include "simulate/random.h"

namespace swath::simulate {

/// The errors of one IMU in the axes of its record: measured = (1 + scale) true + (bias + drift(t)) step + white noise.
class ImuErrors {
 public:
  /// Bias and scale factor of each axis drawn from the model; the drifts run in `step` seconds, from their stationary state.
  ImuErrors(const core::ImuErrorModel& model, double step, std::int64_t seed);

  struct Constant {
    Eigen::Vector3d gyro_bias, gyro_scale, accelerometer_bias, accelerometer_scale;  ///< rad/s, 1, m/s^2, 1
  };
  const Constant& constant() const { return constant_; }

  /// The drifts during the present interval, rad/s and m/s^2.
  Eigen::Vector3d gyro_drift() const;
  Eigen::Vector3d accelerometer_drift() const;
  void advance();

  /// Increments of record k (from 1) as measured in the present interval.
  void measure(std::int64_t k, Eigen::Vector3d& angle, Eigen::Vector3d& velocity) const;

  const core::ImuErrorModel& model() const { return model_; }

 private:
  core::ImuErrorModel model_;
  double step_;
  std::int64_t seed_;
  Constant constant_;
  std::vector<GaussMarkov> drift_;  ///< gyros x y z, accelerometers x y z
};

/// truth/imu.json.
template <class V>
void describe(const ImuErrors& r, V& v) {
  const auto& [gyro_bias, gyro_scale, accelerometer_bias, accelerometer_scale] = r.constant();
  const core::ImuErrorModel& m = r.model();
  v.result("axes", std::string_view("of the record"), "Axes of the vectors.");
  v.result("gyro_bias_rad_per_s", gyro_bias, "Bias of the gyroscopes.");
  v.result("gyro_scale_factor", gyro_scale, "Error of their scale.");
  v.result("accelerometer_bias_m_per_s2", accelerometer_bias, "Bias of the accelerometers.");
  v.result("accelerometer_scale_factor", accelerometer_scale, "Error of their scale.");
  v.result("gyro_drift_sigma_rad_per_s", m.gyro_drift.value, "Sigma of the gyroscopes' drift.");
  v.result("accelerometer_drift_sigma_m_per_s2", m.accelerometer_drift.value, "Sigma of the accelerometers' drift.");
  v.result("drift_time_s", m.drift_time.value, "Correlation time of the drifts.");
  v.result("angular_random_walk_rad_per_sqrt_s", m.angular_random_walk.value, "White noise of the gyroscopes.");
  v.result("velocity_random_walk_m_per_s_per_sqrt_s", m.velocity_random_walk.value, "White noise of the accelerometers.");
}

/// Takes vectors of `body` to the axes of the record: the inverse of what survey.toml states by axes, roll, pitch and heading.
Eigen::Matrix3d record_R_body(const ImuOptions& imu);

/// The model that the errors are drawn from; none where the survey is free of noise.
core::ImuSpec imu_spec_of(const ImuOptions& imu, bool noise_free);

/// imu.csv: seconds of week (counting on past its end), increments over the step that ends there or their mean rates, in the axes of the
/// record; and its truth, truth/imu.json (constant errors) and truth/imu_drift.csv (the drifts, once a second). Folders must exist.
void write_imu(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const ImuOptions& imu, bool noise_free,
               std::int64_t seed);

/// What survey.toml says of imu.csv.
io::ImuFile describe_imu_file(const ImuOptions& imu, core::GpsTime start);

}  // namespace swath::simulate
