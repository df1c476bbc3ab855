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

/// How the errors of a smoothed trajectory at some of its instants are correlated, exactly as the smoother has them. The smoother's whole
/// error state (navigation, biases, fixes' errors ...) is a Markov chain; with its n numbers normalised by what the filter knew (no unit),
///   Cov(e_i, e_j) = left_i * (link_j * ... * link_{i+1})^T * right_j   for i <= j (de Jong and Mackinnon 1988),
/// e: north, east, down (m), roll, pitch, heading (rad), estimated minus true or its opposite. Links are contractions: products of any
/// length keep their digits.
struct ErrorLinks {
  using Left = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  using Right = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  Eigen::Index states = 0;   ///< n
  std::vector<double> time;  ///< GPS time, s, rising
  // One after the other, by columns.
  std::vector<double> lefts, rights, links;

  bool empty() const { return time.empty(); }
  size_t size() const { return time.size(); }
  void resize(size_t instants, Eigen::Index n);
  /// 6 x n.
  Eigen::Map<const Left> left(size_t i) const { return {lefts.data() + 6 * states * index(i), 6, states}; }
  Eigen::Map<Left> left(size_t i) { return {lefts.data() + 6 * states * index(i), 6, states}; }
  /// n x 6.
  Eigen::Map<const Right> right(size_t i) const { return {rights.data() + 6 * states * index(i), states, 6}; }
  Eigen::Map<Right> right(size_t i) { return {rights.data() + 6 * states * index(i), states, 6}; }
  /// n x n, from instant i - 1 to instant i; zeros for i = 0.
  Eigen::Map<const Eigen::MatrixXd> link(size_t i) const { return {links.data() + states * states * index(i), states, states}; }
  Eigen::Map<Eigen::MatrixXd> link(size_t i) { return {links.data() + states * states * index(i), states, states}; }

 private:
  static Eigen::Index index(size_t i) { return static_cast<Eigen::Index>(i); }
};

/// What an error of the calibration that was held while the trajectory was corrected does to it, at some instants, linear in time between
/// them: the trajectory's error has a part that is `per_unit` times the calibration's, and the two cannot be taken as independent.
struct CalibrationResponse {
  static constexpr int values = 11;                 ///< core::calibration_keys
  using Matrix = Eigen::Matrix<double, 6, values>;  ///< north, east, down (m), roll, pitch, heading (rad), per m, rad, s or one

  std::vector<double> time;      ///< GPS time, s, rising
  std::vector<Matrix> per_unit;  ///< empty: the trajectory owes nothing to a calibration

  bool empty() const { return time.empty(); }
  /// The first or last outside them; zero where it is empty.
  Matrix at(double t) const;
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
  ErrorLinks errors;                                          ///< may be empty
  CalibrationResponse response;                               ///< may be empty; its part is in the sigmas

  size_t size() const { return time.size(); }
  bool has_sigma() const { return !sigma_north.empty(); }
  bool has_velocity() const { return !v_north.empty(); }
};

}  // namespace swath::core
