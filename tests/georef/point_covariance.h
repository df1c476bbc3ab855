// SPDX-License-Identifier: GPL-3.0-or-later
// Covariance of one point as the equation has it, beside that of many at once in georeference.cpp.
#pragma once

#include "georef/shot_geometry.h"

namespace swath::georef {

/// A Jacobian in ecef turned to north, east, down at the pose.
inline Jacobian ned_jacobian(const Jacobian& ecef, const trajectory::Pose& pose) { return ecef_R_ned_at(pose).transpose() * ecef; }

/// J S J^T in NED, m^2, with a quarter of the divergence as pointing sigma about both axes across the beam (Schaer et al. 2007). `beam`:
/// vector from scanner to point in the same frame as `by`.
inline Eigen::Matrix3d covariance(const Jacobian& by, const Variances& v, const Eigen::Vector3d& beam, double beam_divergence) {
  const double pointing = beam_divergence / 4.0;
  Eigen::Matrix3d C = pointing * pointing * (beam.squaredNorm() * Eigen::Matrix3d::Identity() - beam * beam.transpose());
  for (int k = 0; k < parameter_count; ++k) C += v[static_cast<size_t>(k)] * by.col(k) * by.col(k).transpose();
  return C;
}

}  // namespace swath::georef
