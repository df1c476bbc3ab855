// SPDX-License-Identifier: GPL-3.0-or-later
// The equation of one laser return and its derivatives. For whole flight lines see georef/georeference.h, which computes the same faster.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/records/sensor.h"
#include "georef/atmosphere.h"
#include "georef/beam.h"
#include "trajectory/trajectory.h"

namespace swath::georef {

/// What a point depends on: the columns of a Jacobian, in this order. Units m, rad, s, or none (scales).
enum Parameter : int {
  boresight_roll,     ///< rad
  boresight_pitch,    ///< rad
  boresight_heading,  ///< rad
  lever_forward,      ///< m, body
  lever_right,        ///< m, body
  lever_down,         ///< m, body
  range_offset,       ///< m
  range_scale,        ///< none
  scan_offset,        ///< rad
  scan_scale,         ///< none
  latency,            ///< s
  position_north,     ///< m, of the IMU centre
  position_east,      ///< m
  position_down,      ///< m
  attitude_roll,      ///< rad
  attitude_pitch,     ///< rad
  attitude_heading,   ///< rad
  record_range,       ///< m, as recorded
  record_angle,       ///< rad, as recorded
  record_time,        ///< s, as recorded
  parameter_count
};

/// Derivatives of a point, m per unit of each parameter.
using Jacobian = Eigen::Matrix<double, 3, parameter_count>;
/// Variances in the order of Parameter.
using Variances = std::array<double, parameter_count>;

/// One return of the scanner: as recorded.
struct Return {
  double angle = 0.0;    ///< rad
  double forward = 0.0;  ///< x of the unit beam (core/shot.h)
  double range = 0.0;    ///< m
};

/// A scanner with its calibration:
///   p_ecef = r_ecef(t) + ecef_R_body(t) * (lever_arm + refract(body_R_scanner * beam(a') * r')),
///   t = t_record + latency,  a' = s_a a + a0,  r' = (s_r r + r0) * (group index in the record / mean group index of the path).
class ShotGeometry {
 public:
  ShotGeometry(const core::Scanner& scanner, const core::Calibration& calibration);

  double time(double recorded) const { return recorded + calibration_.latency.value; }
  double angle(double recorded) const {
    return beam_.ignores_record() ? calibration_.scan_offset.value : calibration_.scan_scale * recorded + calibration_.scan_offset.value;
  }
  double range(double recorded) const {
    return (calibration_.range_scale * recorded + calibration_.range_offset.value) * air_.range_factor;
  }

  /// The point in ecef; `pose` at time(recorded time).
  Eigen::Vector3d ecef_point(const trajectory::Pose& pose, const Return& r) const;
  /// The same with the derivatives of the point in ecef. Position and attitude are perturbed in the NED frame at the IMU (attitude: Euler
  /// angles). Not in them: the turn of the nadir with the IMU's position in the refraction term (1e-12 of a displacement).
  Eigen::Vector3d ecef_point(const trajectory::Pose& pose, const Return& r, Jacobian& by) const;

  const core::Calibration& calibration() const { return calibration_; }
  const BeamModel& beam() const { return beam_; }
  const AirPath& air() const { return air_; }
  const Eigen::Matrix3d& body_R_scanner() const { return body_R_scanner_; }
  const Eigen::Vector3d& lever_arm() const { return lever_arm_; }
  /// Columns: axes in body about which boresight roll, pitch and heading turn the scanner.
  const Eigen::Matrix3d& boresight_axes() const { return boresight_axes_; }

 private:
  core::Calibration calibration_;
  BeamModel beam_;
  AirPath air_;
  Eigen::Matrix3d body_R_scanner_, boresight_axes_;
  Eigen::Vector3d lever_arm_;
};

/// Columns north, east, down in ecef at a pose.
Eigen::Matrix3d ecef_R_ned_at(const trajectory::Pose& pose);
/// Columns: axes in body about which roll, pitch and heading turn it; `down`: the nadir in body.
Eigen::Matrix3d attitude_axes(const Eigen::Vector3d& down);

Variances variances(const core::SensorSigma& sensor, const trajectory::PoseSigma& pose);
/// Of the calibration values boresight_roll .. latency, with the correlations that `sensor` states.
using CalibrationCovariance = Eigen::Matrix<double, latency + 1, latency + 1>;
CalibrationCovariance calibration_covariance(const core::SensorSigma& sensor);

}  // namespace swath::georef
