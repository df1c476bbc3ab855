// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins_smoother.h"

#include <Eigen/Cholesky>

#include "core/frames.h"
#include "core/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix9 = core::CovarianceSeries::Matrix9;

/// Takes small rotations in ecef to changes of roll, pitch and heading: inverse of psi_ned = Rz(h) (Ry(p) x dr + y dp) + z dh.
Matrix3d angles_by_psi(const Matrix3d& ecef_R_ned, const core::Attitude& a) {
  Matrix3d by_angles;
  const core::Attitude turned{0, a.pitch, a.heading}, level{0, 0, a.heading};
  by_angles.col(0) = core::matrix_of(turned).col(0);
  by_angles.col(1) = core::matrix_of(level).col(1);
  by_angles.col(2) = Vector3d::UnitZ();
  return by_angles.inverse() * ecef_R_ned.transpose();
}

FilterNode filter_node(const InsFilter& f) {
  const NavState nav = f.estimate().nav;
  const core::Geodetic g = core::geodetic_of(nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const core::Attitude a = core::attitude_of(ned.transpose() * nav.ecef_R_body);
  const Matrix3d by_psi = angles_by_psi(ned, a);
  FilterNode out;
  out.position = nav.position;
  out.roll_pitch_heading = {a.roll, a.pitch, a.heading};
  out.position_covariance = f.covariance().block<3, 3>(Layout::position, Layout::position);
  out.attitude_covariance = by_psi * f.covariance().block<3, 3>(Layout::attitude, Layout::attitude) * by_psi.transpose();
  return out;
}

/// The adjoint state of the smoother: smoothed error = -P lambda, smoothed covariance = P - P Lambda P.
struct Adjoint {
  StateVector lambda;
  StateMatrix information;

  explicit Adjoint(int n) : lambda(StateVector::Zero(n)), information(StateMatrix::Zero(n, n)) {}

  void pass_update(const Update& u) {
    // (I - K H)^T x = x - H^T (K^T x)
    const StateVector before = lambda;
    lambda = before - u.design.transpose() * (u.gain.transpose() * before + u.weight * u.innovation);
    StateMatrix kept = -u.gain * u.design, moved;
    kept.diagonal().array() += 1.0;
    moved.noalias() = information * kept;
    information.noalias() = kept.transpose() * moved;
    information += u.design.transpose() * u.weight * u.design;
    information = 0.5 * (information + information.transpose()).eval();
  }
  void pass_transition(const StateMatrix& phi) {
    lambda = (phi.transpose() * lambda).eval();
    StateMatrix moved;
    moved.noalias() = information * phi;
    information.noalias() = phi.transpose() * moved;
  }
};

/// P - P Lambda P = L (1 - L^T Lambda L) L^T with P = L L^T: the difference is taken where both sides are of the size 1.
StateMatrix with_future(const StateMatrix& P, const StateMatrix& information) {
  const StateVector scale = P.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const StateMatrix correlation = scale.cwiseInverse().asDiagonal() * P * scale.cwiseInverse().asDiagonal();
  const Eigen::LDLT<StateMatrix> factors(correlation);
  StateMatrix root = factors.matrixL();
  root = (root * factors.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal()).eval();
  root = (factors.transpositionsP().transpose() * root).eval();
  root = (scale.asDiagonal() * root).eval();
  StateMatrix turned, rest;
  turned.noalias() = information * root;
  rest.noalias() = -root.transpose() * turned;
  rest.diagonal().array() += 1.0;
  turned.noalias() = root * rest;
  rest.noalias() = turned * root.transpose();
  return 0.5 * (rest + rest.transpose());
}

SmoothedNode smoothed(const Layout& layout, const NodeRecord& record, const Adjoint& adjoint, bool covariances) {
  SmoothedNode out;
  const StateMatrix& P = record.covariance;
  out.estimate = record.estimate;
  out.estimate.correct(layout, record.mean - P * adjoint.lambda);
  if (!covariances) return out;
  const StateMatrix covariance = with_future(P, adjoint.information);
  out.covariance = core::CovarianceSeries::pack(local_covariance(out.estimate.nav, covariance.topLeftCorner<9, 9>()));
  out.sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return out;
}

}  // namespace

Matrix9 local_covariance(const NavState& nav, const Matrix9& ecef) {
  const core::Geodetic g = core::geodetic_of(nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  Matrix9 turn = Matrix9::Zero();
  turn.block<3, 3>(0, 0) = turn.block<3, 3>(3, 3) = ned.transpose();
  turn.block<3, 3>(6, 6) = angles_by_psi(ned, core::attitude_of(ned.transpose() * nav.ecef_R_body));
  return turn * ecef * turn.transpose();
}

SmootherRun run_smoother(const Problem& problem, const InsFilter& start, bool covariances, size_t stretch) {
  const std::vector<Node>& nodes = problem.nodes;
  SmootherRun run;
  run.nodes.resize(nodes.size());
  run.forward.resize(nodes.size());
  run.outcomes.resize(nodes.size());

  // Forward, leaving the filter at the beginning of each stretch. The last stretch is recorded at once.
  std::vector<InsFilter> left;
  std::vector<NodeRecord> records;
  InsFilter filter = start;
  const size_t stretches = (nodes.size() + stretch - 1) / stretch;
  const auto pass = [&](InsFilter& f, size_t number, bool first_time, bool record) {
    const size_t begin = number * stretch, end = std::min(nodes.size(), begin + stretch);
    if (record) records.resize(end - begin);
    for (size_t k = begin; k < end; ++k) {
      NodeRecord* r = record ? &records[k - begin] : nullptr;
      f.predict(k, r);
      f.update(k, r, first_time ? &run.outcomes[k] : nullptr);
      if (first_time) run.forward[k] = filter_node(f);
    }
  };
  for (size_t s = 0; s < stretches; ++s) {
    left.push_back(filter);
    pass(filter, s, true, s + 1 == stretches);
  }

  Adjoint adjoint(problem.layout.size);
  for (size_t s = stretches; s-- > 0;) {
    if (s + 1 < stretches) pass(left[s], s, false, true);
    for (size_t k = records.size(); k-- > 0;) {
      const NodeRecord& r = records[k];
      run.nodes[s * stretch + k] =
          smoothed(problem.layout, r, adjoint, covariances || (s == 0 && k == 0) || s * stretch + k + 1 == nodes.size());
      for (size_t u = r.updates.size(); u-- > 0;) adjoint.pass_update(r.updates[u]);
      adjoint.pass_transition(r.transition);
    }
    left.pop_back();
  }
  return run;
}

std::vector<FixOutcome> run_forward(const Problem& problem, InsFilter filter) {
  std::vector<FixOutcome> out(problem.nodes.size());
  for (size_t k = 0; k < out.size(); ++k) {
    filter.predict(k, nullptr);
    filter.update(k, nullptr, &out[k]);
  }
  return out;
}

std::vector<FilterNode> run_backward(const Problem& problem, InsFilter filter) {
  std::vector<FilterNode> out(problem.nodes.size());
  for (size_t k = problem.nodes.size(); k-- > 0;) {
    filter.predict(k, nullptr);
    out[k] = filter_node(filter);
    filter.update(k, nullptr, nullptr);
  }
  return out;
}

}  // namespace swath::trajectory
