// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/flight_states.h"

#include <Eigen/Cholesky>

namespace swath::calib {

using Eigen::MatrixXd;
using Eigen::VectorXd;

FlightStates::FlightStates(const trajectory::Layout& l, size_t instants, int calibration)
    : instants_(static_cast<int>(instants)), calibration_(calibration) {
  const auto take = [](std::vector<int>& rows, int first, int n) {
    for (int i = 0; first >= 0 && i < n; ++i) rows.push_back(first + i);
  };
  for (const int first : {l.position, l.attitude, l.velocity, l.gyro_bias, l.force_bias, l.fix}) take(moving_, first, 3);
  for (const int first : {l.gyro_scale, l.force_scale, l.lever}) take(constant_, first, 3);
  take(constant_, l.latency, 1);
  take(constant_, l.track, 2);
}

std::vector<int> FlightStates::sizes() const {
  std::vector<int> out;
  for (int node = 0; node <= common(); ++node) out.push_back(size(node));
  return out;
}

trajectory::StateVector FlightStates::at(int instant, const VectorXd& x) const {
  trajectory::StateVector out(static_cast<Eigen::Index>(moving_.size() + constant_.size()));
  for (size_t i = 0; i < moving_.size(); ++i) out[moving_[i]] = x[first(pose(instant)) + static_cast<Eigen::Index>(i)];
  for (size_t i = 0; i < constant_.size(); ++i) out[constant_[i]] = x[first(common()) + static_cast<Eigen::Index>(i)];
  return out;
}

void NetworkNormals::add(const std::vector<Part>& parts, const MatrixXd& W, const VectorXd& f) {
  const VectorXd weighted = W * f;
  squares += f.dot(weighted);
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto& [node, A] = parts[i];
    if (A.cols() == 0) continue;
    const MatrixXd AtW = A.transpose() * W;
    b.segment(N.first(node), N.size(node)) += A.transpose() * weighted;
    for (size_t j = 0; j <= i; ++j) {
      const auto& [other, B] = parts[j];
      if (B.cols() > 0) N.add(node, other, AtW * B);
    }
  }
}

MatrixXd information_of(MatrixXd covariance, const VectorXd& floor) {
  covariance.diagonal() = covariance.diagonal().cwiseMax(floor);
  const VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const MatrixXd inverse = scaled.llt().solve(MatrixXd::Identity(covariance.rows(), covariance.cols()));
  return scale.asDiagonal() * (0.5 * (inverse + inverse.transpose())) * scale.asDiagonal();
}

}  // namespace swath::calib
