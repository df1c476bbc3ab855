// SPDX-License-Identifier: GPL-3.0-or-later
// Updates in Joseph's form with the gain of the innovation's covariance. An improbable fix is kept with a noise so large that it lies
// on the gate: R' = R + (nis / gate - 1) S.
#include "trajectory/ins/ins_filter.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using Design3 = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, most_states>;

constexpr double still_sigma = 0.02;       // m/s: what an engine or a hand shakes
constexpr double still_interval = 0.2;     // s between updates that count as independent
constexpr double wheels_interval = 0.2;    // s
constexpr double least_wheel_speed = 2.0;  // m/s
constexpr double most_wheel_rate = 0.35;   // rad/s: tyres slip in tighter turns
constexpr double rate_span = 0.03;         // s at a node over which the body's rate is taken

Matrix3d ned_at(const Vector3d& ecef) {
  const core::Geodetic g = core::geodetic_of(ecef);
  return core::ecef_R_ned(g.latitude, g.longitude);
}

}  // namespace

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
  const Node& node = problem_->nodes[number];
  Propagation propagation(l, estimate_);
  const double from = walk_.time();
  Increment piece;
  Vector3d turned = Vector3d::Zero();
  double span = 0.0;
  while (walk_.next(node.time, piece)) {
    propagation.add(piece);
    if (std::abs(node.time - walk_.time()) < rate_span) {
      turned += estimate_.corrected(piece).angle;
      span += piece.step;
    }
  }
  if (span != 0.0) rate_ = turned / span;
  const StateMatrix phi = propagation.transition(problem_->noise);
  const StateVector q =
      propagation.gained(problem_->noise, problem_->path.bridged_within(std::min(from, node.time), std::max(from, node.time)));
  covariance_.diagonal() += 0.5 * q;
  StateMatrix moved;
  moved.noalias() = phi * covariance_;
  covariance_.noalias() = moved * phi.transpose();
  covariance_.diagonal() += 0.5 * q;
  estimate_.nav = propagation.nav();
  if (l.fix >= 0) estimate_.fix *= phi(l.fix, l.fix);
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
double InsFilter::apply(const Eigen::Matrix<double, Rows, Eigen::Dynamic, 0, Rows, most_states>& H,
                        const Eigen::Matrix<double, Rows, 1>& measured, const Eigen::Matrix<double, Rows, Rows>& R, double gate,
                        NodeRecord* record, double* weight) {
  using Square = Eigen::Matrix<double, Rows, Rows>;
  const Eigen::Matrix<double, Rows, 1> y = measured - H * mean_;
  const Eigen::Matrix<double, Eigen::Dynamic, Rows, 0, most_states, Rows> PHt = covariance_ * H.transpose();
  Square S = H * PHt + R;
  S = 0.5 * (S + S.transpose()).eval();
  Square inverse = S.llt().solve(Square::Identity());
  const double nis = y.dot(inverse * y);
  Square noise = R;
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
    if (problem_->options.use_velocity && problem_->gnss.has_velocity()) use_velocity(node, record, outcome);
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
  const Layout& l = problem_->layout;
  const auto k = static_cast<size_t>(node.fix);
  const Matrix3d total = problem_->variance * problem_->gnss.covariance[k];
  const Matrix3d ned = ned_at(problem_->gnss.position[k]);
  const double share = l.fix >= 0 ? problem_->share : 0.0;
  const Vector3d sigma = (ned.transpose() * total * ned).diagonal().cwiseMax(0.0).cwiseSqrt();
  const Matrix3d spread = ned * (std::sqrt(share) * sigma).asDiagonal();
  const Prediction<3> expected = predict_fix(l, estimate_, rate_, spread);
  const Vector3d y = problem_->gnss.position[k] - expected.value;
  if (outcome) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_states, 3> PHt = covariance_ * expected.design.transpose();
    outcome->innovation = ned.transpose() * (y - expected.design * mean_);
    outcome->innovation_sigma = (ned.transpose() * (expected.design * PHt + (1 - share) * total) * ned).diagonal().cwiseSqrt();
  }
  double weight = 1.0;
  const double nis = apply<3>(expected.design, y, (1 - share) * total, problem_->gate, record, &weight);
  if (outcome) {
    outcome->nis = nis;
    outcome->weight = weight;
  }
}

void InsFilter::use_velocity(const Node& node, NodeRecord* record, FixOutcome* outcome) {
  const auto k = static_cast<size_t>(node.fix);
  const Vector3d& measured = problem_->gnss.velocity[k];
  if (!measured.allFinite()) return;
  const Prediction<3> expected = predict_velocity(problem_->layout, estimate_, rate_);
  const double nis =
      apply<3>(expected.design, measured - expected.value, problem_->gnss.velocity_covariance[k], problem_->gate, record, nullptr);
  if (outcome) outcome->velocity_nis = nis;
}

void InsFilter::use_standstill(NodeRecord* record) {
  if (std::abs(estimate_.nav.time - last_virtual_) < still_interval) return;
  last_virtual_ = estimate_.nav.time;
  const Layout& l = problem_->layout;
  Design3 H = Design3::Zero(3, l.size);
  H.block<3, 3>(0, l.velocity).setIdentity();
  apply<3>(H, -estimate_.nav.velocity, still_sigma * still_sigma * Matrix3d::Identity(), problem_->gate, record, nullptr);
}

void InsFilter::use_wheels(NodeRecord* record) {
  const double time = estimate_.nav.time;
  if (std::abs(time - last_virtual_) < wheels_interval || rate_.norm() > most_wheel_rate) return;
  const auto& w = problem_->options.wheel_point;
  double forward = 0.0;
  const Prediction<2> expected = predict_wheels(problem_->layout, estimate_, rate_, Vector3d(w[0].value, w[1].value, w[2].value), forward);
  if (forward < least_wheel_speed) return;
  last_virtual_ = time;
  const double s = problem_->options.non_holonomic_sigma.value;
  apply<2>(expected.design, -expected.value, s * s * Eigen::Matrix2d::Identity(), problem_->gate, record, nullptr);
}

}  // namespace swath::trajectory
