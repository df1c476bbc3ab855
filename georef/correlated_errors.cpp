// SPDX-License-Identifier: GPL-3.0-or-later
// With e_c the calibration's error and G its response in the trajectory, the trajectory's error is G e_c + e_t, e_t independent of e_c:
// its variance is what the trajectory's sigmas leave beside G e_c. Deviation: e_t is taken as six independent components, as everywhere
// that a trajectory states sigmas alone.
#include "georef/correlated_errors.h"

#include <Eigen/Geometry>

namespace swath::georef {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector11 = Eigen::Matrix<double, 11, 1>;

namespace {

enum Shared { turn = 0, shift = 3, of_range = 6, of_range_scale = 7, of_angle = 8, of_angle_scale = 9, of_time = 10 };

}  // namespace

CorrelatedErrors::CorrelatedErrors(const ShotGeometry& g, const core::SensorSigma& sensor, const core::CalibrationResponse& response)
    : response_(&response), lever_arm_(g.lever_arm()) {
  any_ = !sensor.correlation.empty() || !response.empty();
  calibration_ = calibration_covariance(sensor);
  columns_.setZero();
  for (int k = 0; k < 3; ++k) {
    columns_.block<3, 1>(turn, boresight_roll + k) = g.boresight_axes().col(k);
    columns_(shift + k, lever_forward + k) = 1.0;
  }
  columns_(of_range, range_offset) = 1.0;
  columns_(of_range_scale, range_scale) = 1.0;
  columns_(of_angle, scan_offset) = 1.0;
  columns_(of_angle_scale, scan_scale) = g.beam().ignores_record() ? 0.0 : 1.0;
  columns_(of_time, latency) = 1.0;
}

SharedErrors CorrelatedErrors::at(double time, const trajectory::PoseSigma& s, const Matrix3d& base_R_ned) const {
  Eigen::Matrix<double, 11, 6> of_trajectory = Eigen::Matrix<double, 11, 6>::Zero();
  of_trajectory.block<3, 3>(shift, 0) = base_R_ned;
  const Matrix3d axes = attitude_axes(base_R_ned.col(2));
  for (int k = 0; k < 3; ++k) {
    of_trajectory.block<3, 1>(turn, 3 + k) = axes.col(k);
    of_trajectory.block<3, 1>(shift, 3 + k) = axes.col(k).cross(lever_arm_);
  }
  const core::CalibrationResponse::Matrix G = response_->at(time);
  const SharedErrors by_calibration = columns_ + of_trajectory * G;
  Eigen::Matrix<double, 6, 1> own;
  own << s.north, s.east, s.down, s.roll, s.pitch, s.heading;
  own = (own.cwiseAbs2() - (G * calibration_ * G.transpose()).diagonal()).cwiseMax(0.0);
  return by_calibration * calibration_ * by_calibration.transpose() + of_trajectory * own.asDiagonal() * of_trajectory.transpose();
}

PointVariance variance_of(const PointTerms& p, const SharedErrors& Z, const Vector3d& down) {
  Eigen::Matrix<double, 3, 11> J;
  const Vector3d& q = p.ray;
  J << 0.0, q.z(), -q.y(), 1.0, 0.0, 0.0, p.by_range.x(), p.recorded_range * p.by_range.x(), p.by_angle.x(), p.angle * p.by_angle.x(),
      p.by_time.x(),  //
      -q.z(), 0.0, q.x(), 0.0, 1.0, 0.0, p.by_range.y(), p.recorded_range * p.by_range.y(), p.by_angle.y(), p.angle * p.by_angle.y(),
      p.by_time.y(),  //
      q.y(), -q.x(), 0.0, 0.0, 0.0, 1.0, p.by_range.z(), p.recorded_range * p.by_range.z(), p.by_angle.z(), p.angle * p.by_angle.z(),
      p.by_time.z();
  const Eigen::Matrix<double, 3, 11> JZ = J * Z;
  const Matrix3d C = JZ * J.transpose();
  return {C.trace(), down.dot(C * down)};
}

}  // namespace swath::georef
