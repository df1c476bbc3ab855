// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_smoother.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <utility>

#include "core/geo/ellipsoid_normal.h"
#include "core/geo/frames.h"

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
  const Matrix3d ned = core::ellipsoid_normal(nav.position).ecef_R_ned();
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

/// P = L L^T. What is below the rounding of P has no column in L.
class Root {
 public:
  explicit Root(const StateMatrix& P) : scale_(P.diagonal().cwiseMax(1e-300).cwiseSqrt()) {
    factors_.compute(scale_.cwiseInverse().asDiagonal() * P * scale_.cwiseInverse().asDiagonal());
    constexpr double rounding = 1e-14;  // of a correlation matrix of 30 rows
    pivot_ = factors_.vectorD().unaryExpr([](double d) { return d > rounding ? std::sqrt(d) : 0.0; });
    matrix_ = factors_.matrixL();
    matrix_ = (matrix_ * pivot_.asDiagonal()).eval();
    matrix_ = (factors_.transpositionsP().transpose() * matrix_).eval();
    matrix_ = (scale_.asDiagonal() * matrix_).eval();
  }
  const StateMatrix& matrix() const { return matrix_; }
  /// X of L X = `by`, zero in the rows without a column in L.
  StateMatrix solved(const StateMatrix& by) const {
    StateMatrix x = factors_.transpositionsP() * (scale_.cwiseInverse().asDiagonal() * by).eval();
    factors_.matrixL().solveInPlace(x);
    return pivot_.unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; }).asDiagonal() * x;
  }

 private:
  StateVector scale_, pivot_;
  Eigen::LDLT<StateMatrix> factors_;
  StateMatrix matrix_;
};

/// P - P Lambda P = L (1 - L^T Lambda L) L^T: the difference, which this is, is taken where both sides are of the size 1.
StateMatrix kept_share(const StateMatrix& root, const StateMatrix& information) {
  StateMatrix turned, kept;
  turned.noalias() = information * root;
  kept.noalias() = -root.transpose() * turned;
  kept.diagonal().array() += 1.0;
  return kept;
}

SmoothedNode smoothed(const Layout& layout, const NodeRecord& record, const Adjoint& adjoint, const StateMatrix* root,
                      const StateMatrix& kept) {
  SmoothedNode out;
  out.estimate = record.estimate;
  out.estimate.correct(layout, record.mean - record.covariance * adjoint.lambda);
  if (!root) return out;
  StateMatrix turned, covariance;
  turned.noalias() = *root * kept;
  covariance.noalias() = turned * root->transpose();
  covariance = 0.5 * (covariance + covariance.transpose()).eval();
  out.covariance = core::CovarianceSeries::pack(local_covariance(out.estimate.nav, covariance.topLeftCorner<9, 9>()));
  out.sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return out;
}

/// Collects the error links on the way back. Between instants i < j the filter's errors pass by Psi, the product of (I - K H) Phi, and
///   Cov(e_i, e_j) = P_i Psi^T (I - Lambda_j P_j)
/// (de Jong and Mackinnon 1988). With P = L L^T the links are L_j^-1 Psi L_i, the ends L_i and (1 - L_j^T Lambda_j L_j) L_j^T.
class LinkCollector {
 public:
  LinkCollector(const Problem& problem, bool wanted) : size_(problem.layout.size) {
    const double spacing = problem.options.error_spacing.value;
    if (!wanted || !(spacing > 0) || problem.nodes.size() < 2) return;
    constexpr double same = 1e-6;  // s
    const size_t last = problem.nodes.size() - 1;
    for (size_t k = 0; k <= last; ++k)
      if (k == 0 || k == last || problem.nodes[k].time > problem.nodes[instants_.back()].time + spacing - same) instants_.push_back(k);
    links_.resize(instants_.size(), size_);
  }
  /// `node` is the next one on the way back at which there is to be a link.
  bool waits_for(size_t node) const { return !instants_.empty() && instants_.back() == node; }
  void stop(const NavState& nav, const Root& root, const StateMatrix& kept) {
    const size_t i = instants_.size() - 1;
    if (later_) links_.link(i + 1) = later_->solved(way_ * root.matrix());
    const Matrix9 turn = local_by_ecef(nav);
    Eigen::Matrix<double, 6, 9> rows;
    rows << turn.topRows<3>(), turn.bottomRows<3>();
    links_.left(i) = rows * root.matrix().topRows<9>();
    links_.right(i) = kept * links_.left(i).transpose();
    links_.time[i] = nav.time;
    instants_.pop_back();
    later_ = root;
    way_ = StateMatrix::Identity(size_, size_);
  }
  void pass(const NodeRecord& r) {
    if (instants_.empty()) return;
    for (size_t u = r.updates.size(); u-- > 0;) way_ -= ((way_ * r.updates[u].gain).eval() * r.updates[u].design).eval();
    moved_.noalias() = way_ * r.transition;
    way_.swap(moved_);
  }
  core::ErrorLinks take() { return std::move(links_); }

 private:
  int size_;
  std::vector<size_t> instants_;  // those still to come
  core::ErrorLinks links_;
  std::optional<Root> later_;
  StateMatrix way_, moved_;  // Psi
};

}  // namespace

Matrix9 local_by_ecef(const NavState& nav) {
  const Matrix3d ned = core::ellipsoid_normal(nav.position).ecef_R_ned();
  Matrix9 turn = Matrix9::Zero();
  turn.block<3, 3>(0, 0) = turn.block<3, 3>(3, 3) = ned.transpose();
  turn.block<3, 3>(6, 6) = angles_by_psi(ned, core::attitude_of(ned.transpose() * nav.ecef_R_body));
  return turn;
}

Matrix9 local_covariance(const NavState& nav, const Matrix9& ecef) {
  const Matrix9 turn = local_by_ecef(nav);
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
  LinkCollector links(problem, covariances);
  for (size_t s = stretches; s-- > 0;) {
    if (s + 1 < stretches) pass(left[s], s, false, true);
    for (size_t k = records.size(); k-- > 0;) {
      const NodeRecord& r = records[k];
      const size_t node = s * stretch + k;
      std::optional<Root> root;
      StateMatrix kept;
      if (covariances || node == 0 || node + 1 == nodes.size()) {
        root.emplace(r.covariance);
        kept = kept_share(root->matrix(), adjoint.information);
      }
      run.nodes[node] = smoothed(problem.layout, r, adjoint, root ? &root->matrix() : nullptr, kept);
      if (links.waits_for(node)) links.stop(run.nodes[node].estimate.nav, *root, kept);
      links.pass(r);
      for (size_t u = r.updates.size(); u-- > 0;) adjoint.pass_update(r.updates[u]);
      adjoint.pass_transition(r.transition);
    }
    left.pop_back();
  }
  run.errors = links.take();
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
