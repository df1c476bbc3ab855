// SPDX-License-Identifier: GPL-3.0-or-later
// Grades: typical values of data sheets of the class (navigation: ring laser; tactical: fibre-optic or better; compact: small fibre-optic;
// mems: industrial; consumer: of a telephone or a small drone).
#include "core/records/imu_spec.h"

namespace swath::core {
namespace {

constexpr double deg_per_hour = degree / 3600.0, per_root_hour = 1.0 / 60.0, micro_g = 9.80665e-6;

constexpr ImuErrorModel model(double bias, double drift, double walk, double scale_ppm, double force_bias, double force_drift,
                              double force_walk, double force_scale_ppm) {
  ImuErrorModel m;
  m.gyro_bias.value = bias * deg_per_hour;
  m.gyro_drift.value = drift * deg_per_hour;
  m.angular_random_walk.value = walk * degree * per_root_hour;
  m.gyro_scale.value = scale_ppm * 1e-6;
  m.accelerometer_bias.value = force_bias * micro_g;
  m.accelerometer_drift.value = force_drift * micro_g;
  m.velocity_random_walk.value = force_walk * per_root_hour;
  m.accelerometer_scale.value = force_scale_ppm * 1e-6;
  return m;
}

}  // namespace

ImuErrorModel error_model_of(ImuGrade grade) {
  switch (grade) {
    case ImuGrade::unstated:
    case ImuGrade::perfect:
      break;
    case ImuGrade::navigation:
      return model(0.01, 0.003, 0.002, 10, 30, 10, 0.005, 30);
    case ImuGrade::tactical:
      return model(0.1, 0.03, 0.01, 50, 200, 30, 0.015, 100);
    case ImuGrade::compact:
      return model(0.75, 0.3, 0.1, 300, 1000, 100, 0.03, 300);
    case ImuGrade::mems:
      return model(10, 3, 0.15, 1000, 3000, 200, 0.05, 1000);
    case ImuGrade::consumer:
      return model(200, 30, 0.5, 5000, 20000, 1000, 0.15, 5000);
  }
  return {};
}

ImuErrorModel ImuSpec::model() const {
  ImuErrorModel m = error_model_of(grade);
  m.gyro_bias = gyro_bias.value_or(m.gyro_bias);
  m.gyro_drift = gyro_drift.value_or(m.gyro_drift);
  m.angular_random_walk = angular_random_walk.value_or(m.angular_random_walk);
  m.gyro_scale = gyro_scale.value_or(m.gyro_scale);
  m.accelerometer_bias = accelerometer_bias.value_or(m.accelerometer_bias);
  m.accelerometer_drift = accelerometer_drift.value_or(m.accelerometer_drift);
  m.velocity_random_walk = velocity_random_walk.value_or(m.velocity_random_walk);
  m.accelerometer_scale = accelerometer_scale.value_or(m.accelerometer_scale);
  m.drift_time = drift_time.value_or(m.drift_time);
  return m;
}

}  // namespace swath::core
