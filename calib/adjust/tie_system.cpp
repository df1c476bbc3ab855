// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the elimination: Mikhail, "Observations and Least Squares" (1976), partitioned normal equations (Helmert blocking). A group's
// common departure from its plane is a random effect of its own, eliminated by the matrix inversion lemma.
#include "calib/adjust/tie_system.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <stdexcept>

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
    : problem_(&problem),
      bare_(&blocks),
      blocks_(blocks),
      control_(std::move(control)),
      nodes_(std::make_shared<UnknownNodes>(problem.knots->nodes(static_cast<int>(problem.globals.size())))),
      surface_(surface) {
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
    for (size_t g = first; g < last; ++g) rest.index.insert(rest.index.end(), blocks_[g].index.begin() + globals, blocks_[g].index.end());
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
  for (Eigen::Index j = 0; j < m; ++j) into.b[rest.index[static_cast<size_t>(j)]] += sign * b[j];
  into.N.add(rest.index, N.topLeftCorner(m, m), sign);
  return rest;
}

Normals TieSystem::sum(const TieSelection& use, std::vector<PlaneRest>& rests) const {
  Normals out(nodes_);
  rests.clear();
  for (std::uint32_t k = 0; k < planes(); ++k) rests.push_back(add(k, use, 1.0, out));
  return out;
}

TiePrior::TiePrior(const TieProblem& problem, std::shared_ptr<const UnknownNodes> nodes, const ScaleFactors& position,
                   const ScaleFactors& attitude, const VectorXd& correction, VectorXd of_globals, VectorXd of_departure)
    : corrections(std::move(nodes)),
      present(VectorXd::Zero(problem.size())),
      globals(std::move(of_globals)),
      departure(std::move(of_departure)) {
  present.tail(correction.size()) = correction;
  if (correction.size() > 0) problem.knots->add_information(position, attitude, static_cast<int>(problem.globals.size()), corrections);
}

void add_prior(const TiePrior& prior, Normals& n) {
  n.N.add(prior.corrections);
  n.b += prior.corrections.times(prior.present);
  for (Eigen::Index i = 0; i < prior.globals.size(); ++i) n.N.add({static_cast<int>(i)}, MatrixXd::Constant(1, 1, prior.globals[i]));
  n.b.head(prior.globals.size()) += prior.globals.cwiseProduct(prior.departure);
}

MatrixXd TieSolution::of_globals(int globals) const {
  std::vector<int> numbers(static_cast<size_t>(globals));
  std::iota(numbers.begin(), numbers.end(), 0);
  return covariance(numbers);
}

TieSolution solve(const TieSystem& system, const Normals& n, const std::vector<PlaneRest>& rests, Inverse keep) {
  TieSolution out;
  out.d.assign(system.planes(), Vector3d::Zero());
  out.x = VectorXd::Zero(n.b.size());
  auto inverse = std::make_shared<TieInverse>(n.N);
  const VectorXd x = -inverse->solve(n.b);
  if (!x.allFinite()) return out;
  out.x = x;
  out.solved = true;
  if (keep != Inverse::factor) inverse->invert(keep == Inverse::both ? NodeFactor::Keep::factor : NodeFactor::Keep::inverse_alone);
  out.inverse = std::move(inverse);
  for (size_t k = 0; k < rests.size(); ++k) out.d[k] = -rests[k].inverse * (rests[k].b + rests[k].N_xp.transpose() * out.x(rests[k].index));
  return out;
}

Eigen::Matrix3d plane_covariance(const PlaneRest& r, const MatrixXd& of_rest) {
  const MatrixXd gain = r.inverse * r.N_xp.transpose();
  return r.inverse + gain * of_rest * gain.transpose();
}

PlaneRow::PlaneRow(const VectorXd& h, const std::vector<int>& of, const PlaneRest& rest) {
  const Vector3d own = h.tail<3>();
  const Vector3d p = rest.inverse * own;
  // Over the unknowns: h_x - N_xp P^-1 h_p; what is left of the plane is its own.
  value = -rest.N_xp * p;
  own_variance = own.dot(p);
  for (size_t i = 0; i < of.size(); ++i) {
    const auto found = std::lower_bound(rest.index.begin(), rest.index.end(), of[i]);
    if (found == rest.index.end() || *found != of[i]) throw std::logic_error("an unknown that the plane does not touch");
    value[found - rest.index.begin()] += h[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace swath::calib
