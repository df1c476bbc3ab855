// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace swath::core {

/// Full covariances of a trajectory at some of its instants, between which they are linear in time. Order of the nine: north, east, down
/// (m), velocity north, east, down (m/s), roll, pitch, heading (rad).
struct CovarianceSeries {
  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  using Packed = std::array<double, 45>;  ///< upper triangle, row by row

  std::vector<double> time;  ///< GPS time, s, rising
  std::vector<Packed> upper;

  bool empty() const { return time.empty(); }
  static Packed pack(const Matrix9& covariance);
  static Matrix9 unpack(const Packed& packed);
  /// Linear between the two nearest instants (a mean of covariances with weights above zero is one); the first or last outside them.
  Matrix9 at(double t) const;
};

/// A trajectory as recorded: IMU centre and attitude of `body` over time. Columns of one length; the optional ones may be empty.
struct TrajectoryData {
  std::vector<double> time;                         ///< GPS time, s
  std::vector<double> latitude, longitude, height;  ///< rad, rad, ellipsoidal m (WGS84)
  std::vector<double> roll, pitch, heading;         ///< rad; heading from true north, clockwise (wander removed)
  std::vector<double> v_north, v_east, v_down;      ///< m/s; may be empty
  // One-sigma uncertainties; all empty where the file has none.
  std::vector<float> sigma_north, sigma_east, sigma_down;     ///< m
  std::vector<float> sigma_roll, sigma_pitch, sigma_heading;  ///< rad
  CovarianceSeries covariance;                                ///< may be empty

  size_t size() const { return time.size(); }
  bool has_sigma() const { return !sigma_north.empty(); }
  bool has_velocity() const { return !v_north.empty(); }
};

}  // namespace swath::core
