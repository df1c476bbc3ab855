// SPDX-License-Identifier: GPL-3.0-or-later
// The uncertainty of a point where the errors of the calibration are correlated with one another and with the trajectory's.
#pragma once

#include <Eigen/Core>

#include "core/records/trajectory_data.h"
#include "georef/shot_geometry.h"

namespace swath::georef {

/// Errors that all points near an instant share, as few numbers: a turn of the ray (3, rad), a shift (3, m), range offset (m) and scale,
/// scan offset (rad) and scale, time (s). A point's error is linear in them.
using SharedErrors = Eigen::Matrix<double, 11, 11>;

class CorrelatedErrors {
 public:
  /// `response`: of the trajectory; must outlive this object.
  CorrelatedErrors(const ShotGeometry& geometry, const core::SensorSigma& sensor, const core::CalibrationResponse& response);

  /// False where calibration and trajectory have independent errors: sums of squares are enough.
  bool any() const { return any_; }
  /// Covariance of the shared errors at an instant; frames as the base of georef/georeference.cpp: `base_R_ned` turns north, east, down
  /// into it. `sigma`: of the trajectory, what its calibration does to it included.
  SharedErrors at(double time, const trajectory::PoseSigma& sigma, const Eigen::Matrix3d& base_R_ned) const;

 private:
  const core::CalibrationResponse* response_;
  Eigen::Matrix<double, 11, 11> calibration_;  // covariance, by Parameter
  Eigen::Matrix<double, 11, 11> columns_;      // shared errors by each calibration value
  Eigen::Vector3d lever_arm_;
  bool any_ = false;
};

/// What a point's error is made of, in the base frame.
struct PointTerms {
  Eigen::Vector3d ray;        ///< from the scanner to the point, m
  Eigen::Vector3d by_range;   ///< per metre of the range offset
  double recorded_range = 0;  ///< m
  Eigen::Vector3d by_angle;   ///< m per rad of the scan angle
  double angle = 0;           ///< rad
  Eigen::Vector3d by_time;    ///< m/s
};
struct PointVariance {
  double total = 0, down = 0;  ///< m^2
};
/// Of a point by the shared errors.
PointVariance variance_of(const PointTerms& point, const SharedErrors& errors, const Eigen::Vector3d& down);

}  // namespace swath::georef
