// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: w-test and redundancy numbers (Baarda 1968) for the displacement that a group's returns share; the surfaces' variance by
// restricted maximum likelihood, Fisher's scoring (Patterson and Thompson 1971). Deviations: residuals of groups on different planes count
// as uncorrelated in the expected square of the score, which makes a step somewhat too long; in test and score the groups of a plane count
// with their full weights (robust ones would hide what is to be found), those of other planes as they were weighed.
#include "calib/network/plane_tests.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/adjust/tie_system.h"
#include "core/distributions.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double least_redundancy = 1e-3;
// Groups far out do not make the others' sigma: they are left to the test.
constexpr double largest_square = 9.0;
constexpr double least_surface = 1e-4;        // m
constexpr double surface_step = 4.0;          // of the variance, both ways, in one update
constexpr double least_group_freedom = 10.0;  // of groups' means: a sigma known to 22 %
constexpr double change_of_variance = 0.02;   // of groups' means

struct Solution {
  const FlightStates& states;
  const NodeFactor& factor;
  const VectorXd& step;
};

/// Covariance and step of the unknowns that one plane touches, and of the plane itself.
struct PlaneSolution {
  MatrixXd C;  // m + 3
  VectorXd x;  // m + 3
};

PlaneSolution solution_of(const PlaneFactors& planes, std::uint32_t plane, const Solution& solution) {
  const PlaneFactors::Rest& rest = planes.rest(plane);
  const FlightStates& states = solution.states;
  std::vector<int> nodes, first, rows;
  int size = 0;
  const auto m = static_cast<Index>(rest.index.size());
  PlaneSolution out{MatrixXd(m + 3, m + 3), VectorXd(m + 3)};
  for (Index i = 0; i < m; ++i) {
    const PlaneFactors::Place p = planes.place_of(rest.index[static_cast<size_t>(i)], states);
    if (nodes.empty() || nodes.back() != p.node) {
      nodes.push_back(p.node);
      first.push_back(size);
      size += states.size(p.node);
    }
    rows.push_back(first.back() + static_cast<int>(p.row));
    out.x[i] = solution.step[states.first(p.node) + p.row];
  }
  const MatrixXd all = m > 0 ? solution.factor.covariance(nodes) : MatrixXd(0, 0);
  const MatrixXd C = all(rows, rows), gain = C * rest.N_xp * rest.inverse;
  out.C.topLeftCorner(m, m) = C;
  out.C.topRightCorner(m, 3) = -gain;
  out.C.bottomLeftCorner(3, m) = -gain.transpose();
  out.C.bottomRightCorner(3, 3) = rest.inverse + rest.inverse * rest.N_xp.transpose() * gain;
  out.x.tail<3>() = -rest.inverse * (rest.b + rest.N_xp.transpose() * out.x.head(m));
  return out;
}

std::vector<Index> places_in(const std::vector<int>& index, const std::vector<int>& all) {
  std::vector<Index> at;
  for (const int i : index) at.push_back(std::lower_bound(all.begin(), all.end(), i) - all.begin());
  for (Index i = 0; i < 3; ++i) at.push_back(static_cast<Index>(all.size()) + i);
  return at;
}

/// Returns about their own group: what is left of all of them when the mean's part is taken away.
void add_returns(GroupBlock block, double between, double weight, const PlaneSolution& s, const std::vector<Index>& at, double mean_square,
                 double mean_determined, double consistency, KindSums& sums) {
  with_surface(block, std::sqrt(between));
  const MatrixXd C = s.C(at, at);
  const VectorXd x = s.x(at);
  const double squares = weight * (block.c + 2 * block.b.dot(x) + x.dot(block.N * x));
  const double determined = weight * block.N.cwiseProduct(C).sum();
  sums.observations += block.used - 1;
  sums.squares += std::max(0.0, squares - mean_square) / consistency;
  sums.redundancy += block.used - 1.0 - std::max(0.0, determined - mean_determined);
}

void test_control(const TiePlane& plane, std::uint32_t number, const PlaneSolution& s, PlaneTests& out) {
  const std::vector<ControlRow> rows = control_rows({plane}, 1.0);
  for (size_t i = 0; i < rows.size(); ++i) {
    // The plane is where the step has brought it.
    const ControlRow& row = rows[i];
    ControlTest t{plane.control[i].name, number, row.f, 0.0, 0.0, 0.0};
    t.redundancy = std::max(0.0, 1.0 - row.by.dot(s.C.bottomRightCorner<3, 3>() * row.by) / (row.sigma * row.sigma));
    t.sigma = row.sigma * std::sqrt(t.redundancy);
    if (t.redundancy > least_redundancy) t.w = t.residual / t.sigma;
    ++out.control.observations;
    out.control.redundancy += t.redundancy;
    out.control.squares += row.f * row.f / (row.sigma * row.sigma);
    out.points.push_back(t);
  }
}

/// Mean residuals of a plane's groups, and the covariance of what is predicted for them.
struct Means {
  VectorXd residual, weight;
  MatrixXd Q;

  /// What they are with other weights on this plane.
  Means with(const VectorXd& wanted) const {
    const Index n = residual.size();
    const VectorXd added = wanted - weight;
    Means out{residual, wanted, (MatrixXd::Identity(n, n) + Q * added.asDiagonal()).partialPivLu().solve(Q)};
    out.residual -= out.Q * added.cwiseProduct(residual);
    return out;
  }
  double redundancy(Index i) const { return std::max(0.0, 1.0 - Q(i, i) * weight[i]); }
  double w(Index i) const { return residual[i] * std::sqrt(weight[i] / redundancy(i)); }
};

/// All groups are tested with their full weight, `full`. Those far off say nothing of the surfaces and keep their trace of weight there.
void test_groups(const PlaneFactors& planes, const std::vector<size_t>& groups, const Means& solved, const VectorXd& full,
                 PlaneTests& out) {
  const Means tested = solved.with(full);
  VectorXd in_use = full;
  for (Index i = 0; i < full.size(); ++i)
    if (planes.left_out(groups[static_cast<size_t>(i)])) in_use[i] = solved.weight[i];
  const Means surface = solved.with(in_use);
  const MatrixXd P = MatrixXd(in_use.asDiagonal()) - in_use.asDiagonal() * surface.Q * in_use.asDiagonal();
  out.information += P.squaredNorm();
  for (Index i = 0; i < full.size(); ++i) {
    const size_t g = groups[static_cast<size_t>(i)];
    GroupTest& t = out.group[g];
    t.redundancy = tested.redundancy(i);
    if (t.redundancy > least_redundancy) t.displacement = tested.residual[i] / t.redundancy, t.w = tested.w(i);
    if (planes.left_out(g) || surface.redundancy(i) <= least_redundancy) continue;
    out.score += (std::min(std::pow(surface.w(i), 2), largest_square) - 1.0) * surface.redundancy(i) * full[i];
  }
}

void test_plane(const PlaneFactors& planes, std::uint32_t plane, const Solution& solution, PlaneTests& out) {
  std::vector<size_t> groups;
  const auto [begin, end] = planes.groups_of(plane);
  for (size_t g = begin; g < end; ++g)
    if (planes.weight(g) > 0.0 && planes.block(g).used > 0) groups.push_back(g);
  if (groups.empty()) return;
  out.planes += std::any_of(groups.begin(), groups.end(), [&](size_t g) { return !planes.left_out(g); }) ? 1 : 0;
  const PlaneSolution s = solution_of(planes, plane, solution);
  const auto n = static_cast<Index>(groups.size()), m = s.x.size();
  MatrixXd A = MatrixXd::Zero(n, m);
  VectorXd residual(n), variance(n), robust(n);
  for (Index i = 0; i < n; ++i) {
    const size_t g = groups[static_cast<size_t>(i)];
    const GroupBlock& b = planes.block(g);
    const auto k = static_cast<Index>(b.index.size());
    A(i, places_in(b.index, planes.rest(plane).index)) = -b.N.col(k).transpose() / b.weight();
    residual[i] = -b.b[k] / b.weight() + A.row(i).dot(s.x);
    variance[i] = 1.0 / b.weight() + planes.variance_between(g);
    robust[i] = planes.weight(g);
  }
  const VectorXd weight = robust.cwiseQuotient(variance);
  const MatrixXd Q = A * s.C * A.transpose();
  test_groups(planes, groups, {residual, weight, Q}, variance.cwiseInverse(), out);
  for (Index i = 0; i < n; ++i) {
    const size_t g = groups[static_cast<size_t>(i)];
    if (planes.left_out(g)) continue;
    const double square = residual[i] * residual[i] * weight[i], determined = std::min(1.0, Q(i, i) * weight[i]);
    ++out.means.observations;
    out.means.redundancy += 1.0 - determined;
    out.means.squares += square;
    add_returns(planes.block(g), planes.variance_between(g), planes.weight(g), s,
                places_in(planes.block(g).index, planes.rest(plane).index), square, determined, planes.consistency(), out.returns);
  }
  out.plane_sigma[plane] = s.C.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  test_control(planes.planes()[plane], plane, s, out);
}

}  // namespace

PlaneTests test_planes(const PlaneFactors& planes, const FlightStates& states, const NodeFactor& factor, const VectorXd& step) {
  PlaneTests out;
  out.group.resize(planes.groups());
  out.plane_sigma.assign(planes.planes().size(), Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (std::uint32_t k = 0; k < planes.planes().size(); ++k) test_plane(planes, k, {states, factor, step}, out);
  return out;
}

bool surface_is_known(const PlaneTests& tests) { return tests.means.redundancy >= least_group_freedom && tests.information > 0.0; }

bool update_surface(PlaneFactors& planes, const PlaneTests& tests) {
  if (!surface_is_known(tests)) return false;
  constexpr double floor = least_surface * least_surface;
  const double now = planes.surface() * planes.surface();
  const double wanted =
      std::clamp(now + tests.score / tests.information, std::max(floor, now / surface_step), std::max(100 * floor, surface_step * now));
  double before = 0.0, after = 0.0;  // information of all groups
  for (size_t g = 0; g < tests.group.size(); ++g) {
    if (planes.weight(g) <= 0.0 || planes.block(g).used == 0) continue;
    const double variance = 1.0 / planes.block(g).weight() + planes.variance_between(g);
    before += 1.0 / variance;
    after += 1.0 / (variance + wanted - now);
  }
  planes.set_surface(std::sqrt(wanted));
  return std::abs(after - before) > change_of_variance * before;
}

int reject_groups(PlaneFactors& planes, const PlaneTests& tests, double alpha, double share) {
  const double critical = core::normal_quantile(1.0 - 0.5 * alpha);
  struct Candidate {
    double w;
    size_t group;
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t k = 0; k < planes.planes().size(); ++k) {
    Candidate worst{critical, 0};
    bool found = false;
    const auto [begin, end] = planes.groups_of(k);
    for (size_t g = begin; g < end; ++g)
      if (!planes.is_rejected(g) && std::abs(tests.group[g].w) > worst.w) worst = {std::abs(tests.group[g].w), g}, found = true;
    if (found) candidates.push_back(worst);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.w > b.w; });
  const double most = share * static_cast<double>(tests.group.size()) - static_cast<double>(planes.rejected());
  int count = 0;
  for (const Candidate& c : candidates) {
    if (count + 1 > most) break;
    planes.reject(c.group);
    ++count;
  }
  return count;
}

}  // namespace swath::calib
