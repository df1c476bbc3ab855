// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::core {

/// Numbers over time for the report and its plots. Vectors of one group have one length.
struct SmootherSeries {
  // Each node of the smoother.
  std::vector<double> time;                                 ///< GPS time, s
  std::vector<Eigen::Vector3d> separation;                  ///< forward minus backward position, north east down, m; NaN where none
  std::vector<Eigen::Vector3d> separation_sigma;            ///< at most; errors that both passes share do not show, m
  std::vector<Eigen::Vector3d> attitude_separation;         ///< roll pitch heading, rad
  std::vector<double> heading_forward;                      ///< heading of the forward filter minus the smoothed one, rad
  std::vector<Eigen::Vector3d> gyro_bias, gyro_bias_sigma;  ///< rad/s
  std::vector<Eigen::Vector3d> accelerometer_bias, accelerometer_bias_sigma;  ///< m/s^2
  // Each GNSS fix.
  std::vector<double> fix_time;
  std::vector<Eigen::Vector3d> innovation, innovation_sigma;  ///< north east down, m
  std::vector<Eigen::Vector3d> residual;                      ///< fix minus smoothed antenna position, north east down, m
  std::vector<double> nis;                                    ///< normalised innovation squared, 3 degrees of freedom
  std::vector<double> weight;                                 ///< 1, or less where it was down-weighted
};

}  // namespace swath::core
