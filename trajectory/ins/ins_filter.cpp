// SPDX-License-Identifier: GPL-3.0-or-later
// Updates in Joseph's form with the gain of the innovation's covariance. An improbable fix is kept with a noise so large that it lies
// on the gate: R' = R + (nis / gate - 1) S.
#include "trajectory/ins/ins_filter.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace swath::trajectory {

InsFilter::InsFilter(const Problem& problem, Estimate start, StateVector mean, StateMatrix covariance,
                     const std::vector<Estimate>* reference)
    : problem_(&problem),
      reference_(reference),
      estimate_(std::move(start)),
      mean_(std::move(mean)),
      covariance_(std::move(covariance)),
      walk_(problem.path, estimate_.nav.time) {}

Estimate InsFilter::estimate() const {
  Estimate out = estimate_;
  out.correct(problem_->layout, mean_);
  return out;
}

void InsFilter::predict(size_t number, NodeRecord* record) {
  problem_->at_node();
  const Layout& l = problem_->layout;
  const Passage passage = passage_to(*problem_, estimate_, walk_, problem_->nodes[number].time);
  if (passage.rate) rate_ = *passage.rate;
  const StateMatrix& phi = passage.transition;
  covariance_.diagonal() += 0.5 * passage.gained;
  StateMatrix moved;
  moved.noalias() = phi * covariance_;
  covariance_.noalias() = moved * phi.transpose();
  covariance_.diagonal() += 0.5 * passage.gained;
  estimate_ = passage.carried;
  mean_ = (phi * mean_).eval();
  if (reference_) {
    mean_ += estimate_.minus((*reference_)[number], l);
    estimate_ = (*reference_)[number];
  }
  if (record) {
    record->transition = phi;
    record->updates.clear();
  }
}

template <int Rows>
double InsFilter::apply(const Observation<Rows>& o, NodeRecord* record, double* weight) {
  using Square = Eigen::Matrix<double, Rows, Rows>;
  const auto& H = o.design;
  const double gate = problem_->gate;
  const Eigen::Matrix<double, Rows, 1> y = o.residual - H * mean_;
  const Eigen::Matrix<double, Eigen::Dynamic, Rows, 0, most_states, Rows> PHt = covariance_ * H.transpose();
  Square S = H * PHt + o.noise;
  S = 0.5 * (S + S.transpose()).eval();
  Square inverse = S.llt().solve(Square::Identity());
  const double nis = y.dot(inverse * y);
  Square noise = o.noise;
  if (nis > gate) {
    noise += (nis / gate - 1) * S;
    inverse *= gate / nis;
    if (weight) *weight = gate / nis;
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Rows, 0, most_states, Rows> K = PHt * inverse;
  // (I - K H) P (I - K H)^T + K R K^T, written out for few rows.
  const StateMatrix shared = K * PHt.transpose();
  covariance_ -= shared + shared.transpose();
  const Square middle = H * PHt + noise;
  covariance_ += K * middle * K.transpose();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  mean_ += K * y;
  if (!reference_) {
    estimate_.correct(problem_->layout, mean_);
    mean_.setZero();
  }
  if (record) record->updates.push_back({H, K, inverse, y});
  return nis;
}

void InsFilter::update(size_t number, NodeRecord* record, FixOutcome* outcome) {
  const Node& node = problem_->nodes[number];
  if (node.fix >= 0) {
    use_position(node, record, outcome);
    use_velocity(node, record, outcome);
  }
  if (node.still) use_standstill(record);
  if (problem_->layout.track >= 0 && !node.still) use_wheels(record);
  if (record) {
    record->covariance = covariance_;
    record->estimate = estimate_;
    record->mean = mean_;
  }
}

void InsFilter::use_position(const Node& node, NodeRecord* record, FixOutcome* outcome) {
  const auto k = static_cast<size_t>(node.fix);
  const Observation<3> o = observed_position(*problem_, k, estimate_, rate_);
  if (outcome) {
    const Eigen::Matrix3d ned = ned_at(problem_->gnss.position[k]);
    const Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_states, 3> PHt = covariance_ * o.design.transpose();
    outcome->innovation = ned.transpose() * (o.residual - o.design * mean_);
    outcome->innovation_sigma = (ned.transpose() * (o.design * PHt + o.noise) * ned).diagonal().cwiseSqrt();
  }
  double weight = 1.0;
  const double nis = apply<3>(o, record, &weight);
  if (outcome) {
    outcome->nis = nis;
    outcome->weight = weight;
  }
}

void InsFilter::use_velocity(const Node& node, NodeRecord* record, FixOutcome* outcome) {
  const auto o = observed_velocity(*problem_, static_cast<size_t>(node.fix), estimate_, rate_);
  if (!o) return;
  const double nis = apply<3>(*o, record, nullptr);
  if (outcome) outcome->velocity_nis = nis;
}

void InsFilter::use_standstill(NodeRecord* record) {
  if (std::abs(estimate_.nav.time - last_virtual_) < virtual_interval) return;
  last_virtual_ = estimate_.nav.time;
  apply<3>(observed_standstill(*problem_, estimate_), record, nullptr);
}

void InsFilter::use_wheels(NodeRecord* record) {
  if (std::abs(estimate_.nav.time - last_virtual_) < virtual_interval) return;
  const auto o = observed_wheels(*problem_, estimate_, rate_);
  if (!o) return;
  last_virtual_ = estimate_.nav.time;
  apply<2>(*o, record, nullptr);
}

}  // namespace swath::trajectory
