// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the direct georeferencing equation of the project's conventions (Baltsavias, "Airborne laser scanning: basic relations and
// formulas", ISPRS Journal 54 (1999) 199) and its derivatives; error propagation after Schaer, Skaloud, Landtwing & Legat, "Accuracy
// estimation for laser point cloud including scanning geometry" (2007). Deviation: the parameters are taken as uncorrelated.
#include "georef/shot_geometry.h"

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::georef {

using Eigen::Matrix3d;
using Eigen::Vector3d;

ShotGeometry::ShotGeometry(const core::Scanner& scanner, const core::Calibration& c)
    : calibration_(c), beam_(scanner), air_(air_path(scanner)) {
  body_R_scanner_ = core::matrix_of({c.roll.value, c.pitch.value, c.heading.value});
  boresight_axes_.col(0) = body_R_scanner_.col(0);
  boresight_axes_.col(1) = core::matrix_of({0.0, 0.0, c.heading.value}).col(1);
  boresight_axes_.col(2) = Vector3d::UnitZ();
  for (int k = 0; k < 3; ++k) lever_arm_[k] = c.lever_arm_scanner[static_cast<size_t>(k)].value;
}

Vector3d ShotGeometry::ecef_point(const trajectory::Pose& pose, const Return& r) const {
  const Vector3d ray = body_R_scanner_ * (range(r.range) * beam_(angle(r.angle), r.forward).direction);
  if (air_.bending == 0.0) return pose.position + pose.ecef_R_body * (lever_arm_ + ray);
  const Vector3d down = ecef_R_ned_at(pose).col(2);
  return pose.position + pose.ecef_R_body * lever_arm_ + refract(pose.ecef_R_body * ray, down, air_.bending);
}

Vector3d ShotGeometry::ecef_point(const trajectory::Pose& pose, const Return& r, Jacobian& by) const {
  const Matrix3d& R = pose.ecef_R_body;
  const Matrix3d ned = ecef_R_ned_at(pose);
  const Vector3d down = ned.col(2);
  const Beam beam = beam_(angle(r.angle), r.forward);
  const double corrected = range(r.range);
  const Vector3d direction = body_R_scanner_ * beam.direction;
  const Vector3d ray = corrected * direction;
  const Vector3d by_angle = corrected * (body_R_scanner_ * beam.by_angle);
  const Matrix3d bend = refract_jacobian(R * ray, down, air_.bending) * R;  // of the bent ray in ecef with respect to the ray in body

  for (int k = 0; k < 3; ++k) by.col(boresight_roll + k) = bend * boresight_axes_.col(k).cross(ray);
  by.middleCols<3>(lever_forward) = R;
  const double f = air_.range_factor;
  by.col(range_offset) = bend * direction * f;
  by.col(range_scale) = bend * direction * (f * r.range);
  by.col(record_range) = bend * direction * (f * calibration_.range_scale);
  const bool recorded = !beam_.ignores_record();
  by.col(scan_offset) = bend * by_angle;
  by.col(scan_scale) = bend * by_angle * (recorded ? r.angle : 0.0);
  by.col(record_angle) = bend * by_angle * (recorded ? calibration_.scan_scale : 0.0);
  by.middleCols<3>(position_north) = ned;
  const Matrix3d axes = attitude_axes(R.transpose() * down);
  for (int k = 0; k < 3; ++k) by.col(attitude_roll + k) = R * axes.col(k).cross(lever_arm_) + bend * axes.col(k).cross(ray);
  by.col(latency) = pose.velocity + R * pose.rate.cross(lever_arm_) + bend * pose.rate.cross(ray);
  by.col(record_time) = by.col(latency);
  return pose.position + R * lever_arm_ + refract(R * ray, down, air_.bending);
}

Matrix3d ecef_R_ned_at(const trajectory::Pose& pose) {
  const core::Geodetic g = core::geodetic_of(pose.position);
  return core::ecef_R_ned(g.latitude, g.longitude);
}

Matrix3d attitude_axes(const Vector3d& down) {
  Matrix3d axes;
  axes.col(0) = Vector3d::UnitX();
  axes.col(1) = Vector3d(0.0, down.z(), -down.y()).normalized();
  axes.col(2) = down;
  return axes;
}

Variances variances(const core::SensorSigma& s, const trajectory::PoseSigma& p) {
  const auto square = [](double v) { return v * v; };
  Variances v{};
  v[boresight_roll] = square(s.roll.value);
  v[boresight_pitch] = square(s.pitch.value);
  v[boresight_heading] = square(s.heading.value);
  v[lever_forward] = v[lever_right] = v[lever_down] = square(s.lever_arm.value);
  v[range_offset] = square(s.range_offset.value);
  v[range_scale] = square(s.range_scale);
  v[scan_offset] = square(s.scan_offset.value);
  v[scan_scale] = square(s.scan_scale);
  v[latency] = square(s.latency.value);
  v[position_north] = square(p.north);
  v[position_east] = square(p.east);
  v[position_down] = square(p.down);
  v[attitude_roll] = square(p.roll);
  v[attitude_pitch] = square(p.pitch);
  v[attitude_heading] = square(p.heading);
  v[record_range] = square(s.range.value);
  v[record_angle] = square(s.scan_angle.value);
  v[record_time] = square(s.time.value);
  return v;
}

CalibrationCovariance calibration_covariance(const core::SensorSigma& sensor) {
  constexpr int n = latency + 1;
  const bool correlated = sensor.correlation.size() == static_cast<size_t>(n * n);
  const Variances v = variances(sensor, {});
  CalibrationCovariance out = CalibrationCovariance::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i == j || correlated)
        out(i, j) = std::sqrt(v[static_cast<size_t>(i)] * v[static_cast<size_t>(j)]) *
                    (i == j ? 1.0 : sensor.correlation[static_cast<size_t>(i * n + j)]);
  return out;
}

}  // namespace swath::georef
