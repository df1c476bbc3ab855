// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_steps.h"

#include <algorithm>
#include <cmath>

#include "core/geo/ellipsoid_normal.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double still_sigma = 0.02;       // m/s: what an engine or a hand shakes
constexpr double least_wheel_speed = 2.0;  // m/s
constexpr double most_wheel_rate = 0.35;   // rad/s: tyres slip in tighter turns
constexpr double rate_span = 0.03;         // s at a node over which the body's rate is taken

}  // namespace

Matrix3d ned_at(const Vector3d& ecef) { return core::ellipsoid_normal(ecef).ecef_R_ned(); }

StateMatrix Passage::noise() const {
  StateMatrix out = transition * (0.5 * gained).asDiagonal() * transition.transpose();
  out.diagonal() += 0.5 * gained;
  return out;
}

Vector3d level_variance(const Problem& problem, const FixLevel& level) {
  return level.beside.cwiseAbs2().cwiseQuotient(problem.share * problem.variance * level.stated);
}

namespace {

/// Between steps the fixes' correlated error has the sigma of its level in place of the stated one; at a step it is drawn anew.
void pass_steps(const Problem& problem, double begin, double end, Passage& passage) {
  const auto after = std::lower_bound(problem.steps.begin(), problem.steps.end(), std::max(begin, end),
                                      [](const FixStep& s, double t) { return s.time < t; });
  const bool any_before = after != problem.steps.begin();
  const FixStep& step = any_before ? *(after - 1) : *after;
  const bool crossed = any_before && step.time > std::min(begin, end);
  const Vector3d more = level_variance(problem, any_before && (!crossed || end > begin) ? step.after : step.before);
  const int fix = problem.layout.fix;
  if (crossed) {
    passage.transition.middleRows<3>(fix).setZero();
    passage.gained.segment<3>(fix) = 2.0 * (more.array() + 1.0);  // half of it passes the transition, which is zero
  } else {
    const double kept = passage.transition(fix, fix);
    passage.gained.segment<3>(fix) += (1.0 - kept * kept) * more;
  }
}

}  // namespace

Passage passage_to(const Problem& problem, const Estimate& from, ImuWalk& walk, double until) {
  Passage out;
  Propagation propagation(problem.layout, from);
  const double begin = walk.time();
  Increment piece;
  Vector3d turned = Vector3d::Zero();
  double span = 0.0;
  while (walk.next(until, piece)) {
    propagation.add(piece);
    if (std::abs(until - walk.time()) < rate_span) {
      turned += from.corrected(piece).angle;
      span += piece.step;
    }
  }
  if (span != 0.0) out.rate = turned / span;
  out.transition = propagation.transition(problem.noise);
  out.gained = propagation.gained(problem.noise, problem.path.bridged_within(std::min(begin, until), std::max(begin, until)));
  out.carried = from;
  out.carried.nav = propagation.nav();
  if (const int fix = problem.layout.fix; fix >= 0) {
    if (!problem.steps.empty() && problem.share > 0.0) pass_steps(problem, begin, until, out);
    out.carried.fix *= out.transition(fix, fix);
  }
  return out;
}

Observation<3> observed_position(const Problem& problem, size_t k, const Estimate& at, const Vector3d& rate) {
  const Matrix3d total = problem.variance * problem.gnss.covariance[k];
  const Matrix3d ned = ned_at(problem.gnss.position[k]);
  const double share = problem.layout.fix >= 0 ? problem.share : 0.0;
  const Vector3d sigma = (ned.transpose() * total * ned).diagonal().cwiseMax(0.0).cwiseSqrt();
  const Matrix3d spread = ned * (std::sqrt(share) * sigma).asDiagonal();
  const Prediction<3> expected = predict_fix(problem.layout, at, rate, spread);
  return {expected.design, problem.gnss.position[k] - expected.value, (1 - share) * total};
}

std::optional<Observation<3>> observed_velocity(const Problem& problem, size_t k, const Estimate& at, const Vector3d& rate) {
  if (!problem.options.use_velocity || !problem.gnss.has_velocity()) return std::nullopt;
  const Vector3d& measured = problem.gnss.velocity[k];
  if (!measured.allFinite()) return std::nullopt;
  const Prediction<3> expected = predict_velocity(problem.layout, at, rate);
  return Observation<3>{expected.design, measured - expected.value, problem.gnss.velocity_covariance[k]};
}

Observation<3> observed_standstill(const Problem& problem, const Estimate& at) {
  Observation<3> out;
  out.design.setZero(3, problem.layout.size);
  out.design.block<3, 3>(0, Layout::velocity).setIdentity();
  out.residual = -at.nav.velocity;
  out.noise = still_sigma * still_sigma * Matrix3d::Identity();
  return out;
}

std::optional<Observation<2>> observed_wheels(const Problem& problem, const Estimate& at, const Vector3d& rate) {
  if (rate.norm() > most_wheel_rate) return std::nullopt;
  const auto& w = problem.options.wheel_point;
  double forward = 0.0;
  const Prediction<2> expected = predict_wheels(problem.layout, at, rate, Vector3d(w[0].value, w[1].value, w[2].value), forward);
  if (forward < least_wheel_speed) return std::nullopt;
  const double s = problem.options.non_holonomic_sigma.value;
  return Observation<2>{expected.design, -expected.value, s * s * Eigen::Matrix2d::Identity()};
}

}  // namespace swath::trajectory
