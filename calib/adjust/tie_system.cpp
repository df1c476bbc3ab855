// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the elimination: Mikhail, "Observations and Least Squares" (1976), partitioned normal equations (Helmert blocking). A group's
// common departure from its plane is a random effect of its own, eliminated by the matrix inversion lemma.
#include "calib/adjust/tie_system.h"

#include <Eigen/LU>
#include <algorithm>

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// What damps a plane's step where its returns lie on one line or too close together: it does not bias, for the planes' unknowns count from
// the present state. Weak against any real plane (a return weighs 2500 / m^2).
const Vector3d plane_damping(1e-4, 1e-2, 1e-2);  // 1 / m^2, 1, 1

}  // namespace

std::vector<ControlRow> control_rows(const std::vector<TiePlane>& planes, double factor) {
  std::vector<ControlRow> out;
  for (size_t k = 0; k < planes.size(); ++k) {
    const auto axes = plane_axes(planes[k].normal);
    for (const PlaneControl& c : planes[k].control) {
      const Vector3d d = c.point - planes[k].centre;
      out.push_back({static_cast<std::uint32_t>(k), planes[k].normal.dot(d), {-1.0, -axes[0].dot(d), -axes[1].dot(d)}, factor * c.sigma});
    }
  }
  return out;
}

void with_surface(GroupBlock& g, double surface) {
  const auto k = static_cast<Eigen::Index>(g.index.size());
  const double w = g.N(k, k);
  if (surface <= 0.0 || w <= 0.0) return;
  const double factor = 1.0 / (w + 1.0 / (surface * surface));
  const VectorXd n = g.N.col(k);
  const double b = g.b[k];
  g.N -= factor * n * n.transpose();
  g.b -= factor * b * n;
  g.c -= factor * b * b;
}

TieSystem::TieSystem(const TieProblem& problem, const std::vector<GroupBlock>& blocks, std::vector<ControlRow> control, double surface)
    : problem_(&problem), bare_(&blocks), blocks_(blocks), control_(std::move(control)), surface_(surface) {
  for (GroupBlock& b : blocks_) with_surface(b, surface);
  const std::vector<TieGroup>& groups = problem.ties->groups;
  size_t g = 0, c = 0;
  for (std::uint32_t k = 0; k < problem.ties->planes.size(); ++k) {
    first_group_.push_back(g);
    first_control_.push_back(c);
    while (g < groups.size() && groups[g].plane == k) ++g;
    while (c < control_.size() && control_[c].plane == k) ++c;
  }
  first_group_.push_back(g);
  first_control_.push_back(c);
}

PlaneRest TieSystem::add(std::uint32_t plane, const TieSelection& use, double sign, Normals& into, bool white) const {
  PlaneRest rest;
  const int globals = static_cast<int>(problem_->globals.size());
  const auto [first, last] = groups_of(plane);
  for (int i = 0; i < globals; ++i) rest.index.push_back(i);
  if (!white)
    for (size_t g = first; g < last; ++g)
      if (use.group[g]) rest.index.insert(rest.index.end(), blocks_[g].index.begin() + globals, blocks_[g].index.end());
  std::sort(rest.index.begin(), rest.index.end());
  rest.index.erase(std::unique(rest.index.begin(), rest.index.end()), rest.index.end());

  const auto m = static_cast<Eigen::Index>(rest.index.size());
  MatrixXd N = MatrixXd::Zero(m + 3, m + 3);
  VectorXd b = VectorXd::Zero(m + 3);
  std::vector<Eigen::Index> at;
  for (size_t g = first; g < last; ++g) {
    if (!use.group[g]) continue;
    const GroupBlock& block = white ? bare(g) : blocks_[g];
    const auto k = static_cast<Eigen::Index>(block.index.size());
    at.clear();
    for (const int i : block.index) {
      const auto found = std::lower_bound(rest.index.begin(), rest.index.end(), i);
      at.push_back(found != rest.index.end() && *found == i ? found - rest.index.begin() : -1);
    }
    for (Eigen::Index i = 0; i < 3; ++i) at.push_back(m + i);
    for (Eigen::Index j = 0; j < k + 3; ++j) {
      if (at[j] < 0) continue;
      b[at[j]] += block.b[j];
      for (Eigen::Index i = 0; i < k + 3; ++i)
        if (at[i] >= 0) N(at[i], at[j]) += block.N(i, j);
    }
  }
  const auto [first_row, last_row] = control_of(plane);
  for (size_t c = first_row; c < last_row; ++c) {
    if (!use.control[c]) continue;
    const ControlRow& row = control_[c];
    const double w = 1.0 / (row.sigma * row.sigma);
    N.bottomRightCorner<3, 3>() += w * row.by * row.by.transpose();
    b.tail<3>() += w * row.f * row.by;
  }
  N.bottomRightCorner<3, 3>().diagonal() += plane_damping;
  rest.inverse = Matrix3d(N.bottomRightCorner<3, 3>()).inverse();
  rest.N_xp = N.topRightCorner(m, 3);
  rest.b = b.tail<3>();

  const MatrixXd gain = rest.N_xp * rest.inverse;
  N.topLeftCorner(m, m).noalias() -= gain * rest.N_xp.transpose();
  b.head(m) -= gain * rest.b;
  for (Eigen::Index j = 0; j < m; ++j) {
    into.b[rest.index[j]] += sign * b[j];
    for (Eigen::Index i = 0; i < m; ++i) into.N(rest.index[i], rest.index[j]) += sign * N(i, j);
  }
  return rest;
}

Normals TieSystem::sum(const TieSelection& use, std::vector<PlaneRest>& rests) const {
  const int n = problem_->size();
  Normals out{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  rests.clear();
  for (std::uint32_t k = 0; k < planes(); ++k) rests.push_back(add(k, use, 1.0, out));
  return out;
}

void add_prior(const TiePrior& prior, Normals& n, bool of_globals) {
  const Eigen::Index globals = prior.globals.size(), knots = prior.correction.size();
  n.N.bottomRightCorner(knots, knots) += prior.corrections;
  n.b.tail(knots) += prior.corrections * prior.correction;
  if (!of_globals) return;
  n.N.diagonal().head(globals) += prior.globals;
  n.b.head(globals) += prior.globals.cwiseProduct(prior.departure);
}

TieSolution solve(const TieSystem& system, const Normals& n, const std::vector<PlaneRest>& rests, bool covariance) {
  TieSolution out;
  const Eigen::Index size = n.N.rows();
  // Scaled to ones on the diagonal: the unknowns are of different units.
  const VectorXd scale = n.N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(scale.asDiagonal() * n.N * scale.asDiagonal());
  out.d.assign(system.planes(), Vector3d::Zero());
  out.x = VectorXd::Zero(size);
  if (llt.info() != Eigen::Success) return out;
  out.solved = true;
  out.x = -(scale.asDiagonal() * llt.solve(scale.asDiagonal() * n.b));
  if (covariance) {
    out.covariance = llt.solve(MatrixXd::Identity(size, size));
    out.covariance = scale.asDiagonal() * out.covariance * scale.asDiagonal();
  }
  for (size_t k = 0; k < rests.size(); ++k) {
    VectorXd x(static_cast<Eigen::Index>(rests[k].index.size()));
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = out.x[rests[k].index[i]];
    out.d[k] = -rests[k].inverse * (rests[k].b + rests[k].N_xp.transpose() * x);
  }
  return out;
}

namespace {

MatrixXd part_of(const MatrixXd& covariance, const std::vector<int>& index) {
  const auto m = static_cast<Eigen::Index>(index.size());
  MatrixXd out(m, m);
  for (Eigen::Index j = 0; j < m; ++j)
    for (Eigen::Index i = 0; i < m; ++i) out(i, j) = covariance(index[i], index[j]);
  return out;
}

}  // namespace

Eigen::Matrix3d plane_covariance(const PlaneRest& r, const MatrixXd& covariance) {
  const MatrixXd gain = r.inverse * r.N_xp.transpose();
  return r.inverse + gain * part_of(covariance, r.index) * gain.transpose();
}

PlaneRow::PlaneRow(const VectorXd& h, const std::vector<int>& of, const PlaneRest& rest) {
  const Vector3d own = h.tail<3>();
  const Vector3d p = rest.inverse * own;
  index = rest.index;
  // Over the unknowns: h_x - N_xp P^-1 h_p; what is left of the plane is its own.
  const VectorXd g = -rest.N_xp * p;
  value.assign(g.data(), g.data() + g.size());
  own_variance = own.dot(p);
  for (size_t i = 0; i < of.size(); ++i) {
    const auto end = index.begin() + static_cast<std::ptrdiff_t>(rest.index.size());
    const auto found = std::lower_bound(index.begin(), end, of[i]);
    if (found != end && *found == of[i]) {
      value[static_cast<size_t>(found - index.begin())] += h[i];
    } else {
      index.push_back(of[i]);
      value.push_back(h[i]);
    }
  }
}

double PlaneRow::covariance(const PlaneRow& other, const MatrixXd& of_unknowns) const {
  double sum = 0.0;
  for (size_t j = 0; j < other.index.size(); ++j) {
    double s = 0.0;
    for (size_t i = 0; i < index.size(); ++i) s += of_unknowns(index[i], other.index[j]) * value[i];
    sum += s * other.value[j];
  }
  return sum;
}

}  // namespace swath::calib
