// SPDX-License-Identifier: GPL-3.0-or-later
// Normal equations by nodes, factorised by fronts and inverted on the factor's pattern (calib/sparse/node_matrix.h): time and memory grow
// with the number of instants, and nothing dense is ever of the flight's size.
#include "calib/network/network.h"

#include <cmath>

#include "core/error.h"

namespace swath::calib {
namespace {

constexpr double network_settled = 0.05;  // sigmas

}  // namespace

using Eigen::MatrixXd;
using Eigen::VectorXd;

Network::Network(const trajectory::Problem& problem, std::vector<trajectory::Estimate> start, std::vector<trajectory::FixOutcome> outcomes,
                 NavigationPrior prior, int calibration)
    : problem_(&problem),
      states_(problem.layout, problem.nodes.size(), calibration),
      estimates_(std::move(start)),
      outcomes_(std::move(outcomes)),
      prior_(std::move(prior)),
      calibration_(VectorXd::Zero(calibration)) {
  // One value of each constant for all instants: the first one's.
  const trajectory::Layout& l = problem.layout;
  trajectory::StateVector back = trajectory::StateVector::Zero(l.size);
  for (trajectory::Estimate& e : estimates_) {
    const trajectory::StateVector away = estimates_.front().minus(e, l);
    for (const int row : states_.constant()) back[row] = away[row];
    e.correct(l, back);
  }
}

double Network::step(const Others& others) {
  NetworkNormals normals(states_.sizes());
  add_navigation(*problem_, states_, estimates_, outcomes_, prior_, normals);
  if (others) others(normals);
  squares_ = normals.squares;
  factor_.reset();  // as large as the new one
  factor_ = std::make_unique<NodeFactor>(normals.N);
  x_ = factor_->solve(normals.b);
  if (!x_.allFinite())
    throw core::Error("the joint adjustment of IMU, GNSS and planes cannot be solved", "calib.network",
                      "check the IMU's stated noise (imu_spec) and the fixes' sigmas");
  for (int k = 0; k < states_.instants(); ++k) estimates_[static_cast<size_t>(k)].correct(problem_->layout, states_.at(k, x_));
  calibration_ += x_.tail(calibration_.size());
  return std::sqrt(std::max(0.0, x_.dot(normals.b)));
}

int Network::solve(const Others& others, int most) {
  double before = step(others);
  int n = 1;
  while (before > network_settled && n < most) {
    const double now = step(others);
    ++n;
    if (now > 0.5 * before && now < 1.0) break;
    before = now;
  }
  return n;
}

std::vector<trajectory::SmoothedNode> Network::smoothed() const {
  const trajectory::Layout& l = problem_->layout;
  const VectorXd common = factor_->covariance({states_.common()}).diagonal().cwiseMax(0.0).cwiseSqrt();
  std::vector<trajectory::SmoothedNode> out(estimates_.size());
  MatrixXd C = MatrixXd::Zero(l.size, l.size);  // in the layout's order
  for (int k = 0; k < states_.instants(); ++k) {
    trajectory::SmoothedNode& node = out[static_cast<size_t>(k)];
    node.estimate = estimates_[static_cast<size_t>(k)];
    C(states_.moving(), states_.moving()) = factor_->covariance({states_.pose(k), states_.motion(k)});
    node.covariance = core::CovarianceSeries::pack(local_covariance(node.estimate.nav, C.topLeftCorner<9, 9>()));
    node.sigma = C.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (size_t i = 0; i < states_.constant().size(); ++i) node.sigma[states_.constant()[i]] = common[static_cast<Eigen::Index>(i)];
  }
  return out;
}

MatrixXd Network::calibration_covariance() const {
  return factor_->covariance({states_.common()}).bottomRightCorner(calibration_.size(), calibration_.size());
}

}  // namespace swath::calib
