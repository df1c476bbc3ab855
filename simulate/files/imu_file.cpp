// SPDX-License-Identifier: GPL-3.0-or-later
// The drift is held during a step: of a process that also moves within it, 3e-6 of the white noise's variance is left out at most (any
// grade at 50 Hz).
#include "simulate/files/imu_file.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "io/text/text_rows.h"
#include "io/text/value_file.h"
#include "simulate/files/laser_file.h"
#include "simulate/inertial.h"

namespace swath::simulate {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr std::int64_t batch = 1 << 15;  // records whose increments are made at once

}  // namespace

ImuErrors::ImuErrors(const core::ImuErrorModel& model, double step, std::int64_t seed) : model_(model), step_(step), seed_(seed) {
  Random random = random_of(seed, Stream::inertial, 0);
  for (Eigen::Index i = 0; i < 3; ++i) {
    constant_.gyro_bias[i] = model.gyro_bias.value * random.normal();
    constant_.gyro_scale[i] = model.gyro_scale.value * random.normal();
    constant_.accelerometer_bias[i] = model.accelerometer_bias.value * random.normal();
    constant_.accelerometer_scale[i] = model.accelerometer_scale.value * random.normal();
  }
  for (std::uint64_t i = 0; i < 6; ++i) drift_.emplace_back(model.drift_time.value, random_of(seed, Stream::imu_drift, i));
}

Vector3d ImuErrors::gyro_drift() const {
  return model_.gyro_drift.value * Vector3d(drift_[0].value(), drift_[1].value(), drift_[2].value());
}

Vector3d ImuErrors::accelerometer_drift() const {
  return model_.accelerometer_drift.value * Vector3d(drift_[3].value(), drift_[4].value(), drift_[5].value());
}

void ImuErrors::advance() {
  for (GaussMarkov& d : drift_) d.advance(step_);
}

void ImuErrors::measure(std::int64_t k, Vector3d& angle, Vector3d& velocity) const {
  Random random = random_of(seed_, Stream::inertial, static_cast<std::uint64_t>(k));
  const auto white = [&](double walk) -> Vector3d {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return walk * std::sqrt(step_) * Vector3d(x, y, z);
  };
  const Vector3d one = Vector3d::Ones();
  angle = angle.cwiseProduct(one + constant_.gyro_scale) + step_ * (constant_.gyro_bias + gyro_drift()) +
          white(model_.angular_random_walk.value);
  velocity = velocity.cwiseProduct(one + constant_.accelerometer_scale) + step_ * (constant_.accelerometer_bias + accelerometer_drift()) +
             white(model_.velocity_random_walk.value);
}

Matrix3d record_R_body(const ImuOptions& imu) {
  // `axes` names the record's axes that point along x, y, z of the sensor as mounted.
  Matrix3d sensor_R_record = Matrix3d::Zero();
  for (size_t i = 0; i < 3; ++i)
    sensor_R_record(static_cast<Eigen::Index>(i), imu.axes[i].back() - 'x') = imu.axes[i].front() == '-' ? -1.0 : 1.0;
  const Matrix3d body_R_sensor = core::matrix_of({imu.roll.value, imu.pitch.value, imu.heading.value});
  return (body_R_sensor * sensor_R_record).transpose();
}

core::ImuSpec imu_spec_of(const ImuOptions& imu, bool noise_free) { return noise_free ? spec_of(core::ImuGrade::perfect) : imu.spec; }

void write_imu(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const ImuOptions& imu, bool noise_free,
               std::int64_t seed) {
  const bool rates = imu.kind == io::ImuKind::rates;
  const double rate = imu.rate.value, step = 1.0 / rate;
  io::TextRows rows(folder / "imu.csv", rates ? "gps_sow_s,gyro_x_radps,gyro_y_radps,gyro_z_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2\n"
                                              : "gps_sow_s,dtheta_x_rad,dtheta_y_rad,dtheta_z_rad,dv_x_mps,dv_y_mps,dv_z_mps\n");
  io::TextRows drift(folder / "truth" / "imu_drift.csv",
                     "gps_sow_s,gyro_x_radps,gyro_y_radps,gyro_z_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2\n");
  ImuErrors errors(imu_spec_of(imu, noise_free).model(), step, seed);
  const Matrix3d R = record_R_body(imu);
  const double sow = start - core::seconds_per_week * core::week_of(start);
  const int decimals = io::decimals_of(sow, step, 4);
  const auto put = [](io::TextRows& to, const Vector3d& v) {
    for (const double x : v) to.scientific(x, 12);
  };
  const auto last = static_cast<std::int64_t>(std::floor(flight.duration() * rate + 1e-9));
  double next_drift = 0.0;  // s
  std::vector<Increments> made(static_cast<size_t>(std::min(batch, last)));
  for (std::int64_t begin = 1; begin <= last; begin += batch) {
    const std::int64_t end = std::min(last + 1, begin + batch);
    tbb::parallel_for(begin, end, [&](std::int64_t k) {
      made[static_cast<size_t>(k - begin)] = increments_of(flight, static_cast<double>(k) / rate, step);
    });
    for (std::int64_t k = begin; k < end; ++k) {
      const double t = static_cast<double>(k) / rate;
      Vector3d angle = R * made[static_cast<size_t>(k - begin)].angle, velocity = R * made[static_cast<size_t>(k - begin)].velocity;
      errors.measure(k, angle, velocity);
      rows.number(sow + t, decimals);
      put(rows, rates ? Vector3d(angle * rate) : angle);
      put(rows, rates ? Vector3d(velocity * rate) : velocity);
      rows.end();
      if (t >= next_drift) {
        drift.number(sow + t, decimals);
        put(drift, errors.gyro_drift());
        put(drift, errors.accelerometer_drift());
        drift.end();
        next_drift += 1.0;
      }
      errors.advance();
    }
  }
  rows.commit();
  drift.commit();
  io::write_text_file(folder / "truth" / "imu.json", io::to_json(core::reported(errors)));
}

io::ImuFile describe_imu_file(const ImuOptions& imu, core::GpsTime start) {
  io::ImuFile f;
  f.file = "imu.csv";
  f.time = tags_of(core::TimeScale::gps_week, start);
  f.kind = imu.kind;
  f.angle_unit = io::AngleUnit::rad;
  f.acceleration_unit = io::AccelerationUnit::mps2;
  f.rate = imu.rate;
  f.axes = imu.axes;
  f.roll = imu.roll;
  f.pitch = imu.pitch;
  f.heading = imu.heading;
  if (imu.kind == io::ImuKind::rates)
    f.columns = {"gps_sow_s", "", "gyro_x_radps", "gyro_y_radps", "gyro_z_radps", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2"};
  else
    f.columns = {"gps_sow_s", "", "dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_mps", "dv_y_mps", "dv_z_mps"};
  return f;
}

}  // namespace swath::simulate
