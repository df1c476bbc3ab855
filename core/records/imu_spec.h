// SPDX-License-Identifier: GPL-3.0-or-later
// What an inertial sensor's data sheet says of its errors, and named grades of it.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/config/option.h"

namespace swath::core {

enum class ImuGrade { unstated, perfect, navigation, tactical, compact, mems, consumer };
template <>
struct Choices<ImuGrade> {
  static constexpr std::array<std::string_view, 7> names{"unstated", "perfect", "navigation", "tactical", "compact", "mems", "consumer"};
};

/// One-sigma values, each axis: measured = (1 + scale) true + bias + drift(t) + white noise; drift is first-order Gauss-Markov.
struct ImuErrorModel {
  RadiansPerSecond gyro_bias;   ///< constant part, from switching on
  RadiansPerSecond gyro_drift;  ///< Gauss-Markov part
  AngularWalk angular_random_walk;
  Ratio gyro_scale;
  MetresPerSecond2 accelerometer_bias;
  MetresPerSecond2 accelerometer_drift;
  VelocityWalk velocity_random_walk;
  Ratio accelerometer_scale;
  Seconds drift_time{1800.0};  ///< correlation time of both drifts
};

/// Values of a grade (`unstated` and `perfect`: zeros).
ImuErrorModel error_model_of(ImuGrade grade);

/// A grade, and what is known better than by it.
struct ImuSpec {
  ImuGrade grade = ImuGrade::unstated;
  std::optional<RadiansPerSecond> gyro_bias, gyro_drift;
  std::optional<AngularWalk> angular_random_walk;
  std::optional<Ratio> gyro_scale;
  std::optional<MetresPerSecond2> accelerometer_bias, accelerometer_drift;
  std::optional<VelocityWalk> velocity_random_walk;
  std::optional<Ratio> accelerometer_scale;
  std::optional<Seconds> drift_time;

  ImuErrorModel model() const;
};

template <class V>
void describe(ImuSpec& s, V& v) {
  v.option(
      "grade", s.grade,
      "Named grade that fills the values below that are not given: navigation (0.01 deg/h, 0.002 deg/sqrt(h), 10 ppm), tactical (0.1 "
      "deg/h, "
      "0.01 deg/sqrt(h), 50 ppm), compact (small fibre-optic: 0.75 deg/h, 0.1 deg/sqrt(h), 300 ppm), mems (10 deg/h, 0.15 deg/sqrt(h), "
      "1000 ppm), consumer (200 deg/h, 0.5 deg/sqrt(h), 5000 ppm), perfect.");
  v.option("gyro_bias", s.gyro_bias, at_least(0), "Sigma of the constant part of a gyro's bias.");
  v.option("gyro_drift", s.gyro_drift, at_least(0), "Sigma of the part of it that drifts (first-order Gauss-Markov).");
  v.option("angular_random_walk", s.angular_random_walk, at_least(0), "White noise of the angular rate.");
  v.option("gyro_scale", s.gyro_scale, at_least(0), "Sigma of a gyro's scale factor error.");
  v.option("accelerometer_bias", s.accelerometer_bias, at_least(0), "Sigma of the constant part of an accelerometer's bias.");
  v.option("accelerometer_drift", s.accelerometer_drift, at_least(0), "Sigma of the part of it that drifts.");
  v.option("velocity_random_walk", s.velocity_random_walk, at_least(0), "White noise of the specific force.");
  v.option("accelerometer_scale", s.accelerometer_scale, at_least(0), "Sigma of an accelerometer's scale factor error.");
  v.option("drift_time", s.drift_time, above(0), "Correlation time of the drifts.");
}

}  // namespace swath::core
