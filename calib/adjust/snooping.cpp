// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Baarda, "A testing procedure for use in geodetic networks" (1968): w-test and redundancy numbers, here for the displacement that
// all returns of a group share. Rejection in batches is not his: tests of different planes hardly depend on one another.
#include "calib/adjust/snooping.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/distributions.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double least_redundancy = 1e-3;
// A shift of control smaller than this is left to the tests of single points.
constexpr double least_shift = 0.3;          // m
constexpr double known_sigma = 0.5;          // m: of a component of the shift that is known
constexpr double shift_significance = 30.0;  // chi-square of three: 1e-6
constexpr double majority = 0.6;

VectorXd steps_of(const std::vector<int>& index, const TieSolution& s, std::uint32_t plane) {
  VectorXd out(static_cast<Eigen::Index>(index.size()) + 3);
  for (size_t i = 0; i < index.size(); ++i) out[i] = s.x[index[i]];
  out.tail<3>() = s.d[plane];
  return out;
}

TieTest test_of(double sum, double weight, double unknowns_variance, bool used) {
  // sum: weighted sum of the residuals; weight: of the mean residual; unknowns_variance: of that mean's prediction.
  TieTest t;
  if (weight <= 0.0) return t;
  if (!used) {
    t.redundancy = 1.0;
    t.displacement = sum / weight;
    t.information = 1.0 / (1.0 / weight + unknowns_variance);
    t.w = t.displacement * std::sqrt(t.information);
    return t;
  }
  t.redundancy = std::clamp(1.0 - weight * unknowns_variance, 0.0, 1.0);
  t.information = weight * t.redundancy;
  if (t.redundancy < least_redundancy) return t;
  t.displacement = sum / t.information;
  t.w = sum / std::sqrt(t.information);
  return t;
}

}  // namespace

TieTests tests_of(const TieSystem& system, const TieSolution& s, const std::vector<PlaneRest>& rests, const TieSelection& use) {
  TieTests out;
  out.group.resize(use.group.size());
  out.control.resize(use.control.size());
  for (std::uint32_t k = 0; k < system.planes(); ++k) {
    const auto [first, last] = system.groups_of(k);
    const MatrixXd of_rest = s.covariance(rests[k].index);
    for (size_t g = first; g < last; ++g) {
      const GroupBlock& b = system.block(g);
      const auto at = static_cast<Eigen::Index>(b.index.size());
      if (b.used == 0 || !(b.N(at, at) > 0.0)) continue;
      // The displacement's column is that of -d0.
      const double weight = b.N(at, at);
      const double sum = -(b.b[at] + b.N.col(at).dot(steps_of(b.index, s, k)));
      const PlaneRow row(-b.N.col(at) / weight, b.index, rests[k]);
      out.group[g] = test_of(sum, weight, row.variance(of_rest), use.group[g]);
    }
    const auto [first_row, last_row] = system.control_of(k);
    for (size_t c = first_row; c < last_row; ++c) {
      const ControlRow& r = system.control()[c];
      const double weight = 1.0 / (r.sigma * r.sigma);
      const PlaneRow row(VectorXd(r.by), {}, rests[k]);
      out.control[c] = test_of(weight * (r.f + r.by.dot(s.d[k])), weight, row.variance(of_rest), use.control[c]);
    }
  }
  return out;
}

int reject_worst(const TieSystem& system, const TieTests& tests, const SnoopingOptions& o, TieSelection& use, bool& full) {
  struct Candidate {
    double w;
    std::uint32_t plane;
    size_t number;
    bool control;
  };
  std::vector<Candidate> candidates;
  const double critical = core::normal_quantile(1.0 - 0.5 * o.alpha);
  for (std::uint32_t k = 0; k < system.planes(); ++k) {
    const auto [first, last] = system.groups_of(k);
    for (size_t g = first; g < last; ++g)
      if (use.group[g] && std::abs(tests.group[g].w) > critical) candidates.push_back({std::abs(tests.group[g].w), k, g, false});
    const auto [first_row, last_row] = system.control_of(k);
    for (size_t c = first_row; c < last_row; ++c)
      if (use.control[c] && std::abs(tests.control[c].w) > critical) candidates.push_back({std::abs(tests.control[c].w), k, c, true});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.w > b.w; });
  const auto out_of = [](const std::vector<char>& v) { return static_cast<double>(std::count(v.begin(), v.end(), char{0})); };
  double groups_out = out_of(use.group), control_out = out_of(use.control);
  std::vector<char> taken(system.planes(), 0);
  int count = 0;
  full = false;
  for (const Candidate& c : candidates) {
    if (c.w < 0.5 * candidates.front().w) break;
    if (taken[c.plane]) continue;
    std::vector<char>& list = c.control ? use.control : use.group;
    double& gone = c.control ? control_out : groups_out;
    // One wrong point among few may always go.
    if (gone + 1.0 > std::max(1.0, o.share * static_cast<double>(list.size()))) {
      full = true;
      continue;
    }
    list[c.number] = 0;
    taken[c.plane] = 1;
    gone += 1.0;
    ++count;
  }
  return count;
}

namespace {

/// Covariance of the control's predictions, without what those of one plane share of it. Some columns at a time.
MatrixXd predicted_covariance(const std::vector<ControlRow>& rows, const TieSolution& s, const std::vector<PlaneRest>& rests) {
  constexpr Eigen::Index at_a_time = 32;
  const auto n = static_cast<Eigen::Index>(rows.size());
  const auto value = [&](Eigen::Index i) { return PlaneRow(VectorXd(rows[i].by), std::vector<int>{}, rests[rows[i].plane]).value; };
  MatrixXd out(n, n);
  for (Eigen::Index first = 0; first < n; first += at_a_time) {
    const Eigen::Index count = std::min(at_a_time, n - first);
    MatrixXd some = MatrixXd::Zero(s.x.size(), count);
    for (Eigen::Index k = 0; k < count; ++k) some(rests[rows[first + k].plane].index, k) = value(first + k);
    some = s.inverse->solve(some);
    for (Eigen::Index i = 0; i < n; ++i)
      out.block(i, first, 1, count) = value(i).transpose() * some(rests[rows[i].plane].index, Eigen::all);
  }
  return out;
}

}  // namespace

ControlShift control_shift(const TieSystem& system, const std::vector<TiePlane>& planes, const TieSolution& s,
                           const std::vector<PlaneRest>& rests) {
  ControlShift out;
  const std::vector<ControlRow>& rows = system.control();
  const auto n = static_cast<Eigen::Index>(rows.size());
  if (n == 0) return out;
  VectorXd misfit(n);
  MatrixXd normals(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ControlRow& r = rows[i];
    misfit[i] = r.f + r.by.dot(s.d[r.plane]);
    normals.row(i) = planes[r.plane].normal.transpose();
  }
  MatrixXd C = predicted_covariance(rows, s, rests);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      if (rows[j].plane == rows[i].plane) C(i, j) += rows[j].by.dot(rests[rows[i].plane].inverse * rows[i].by);
      if (i == j) C(i, i) += rows[i].sigma * rows[i].sigma;
      C(j, i) = C(i, j);
    }
  const Eigen::LDLT<MatrixXd> weight(C);
  const Eigen::Matrix3d N = normals.transpose() * weight.solve(normals);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(N);
  // Only along directions that the planes determine.
  const Vector3d right = normals.transpose() * weight.solve(misfit);
  Eigen::Matrix3d told = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (eigen.eigenvalues()[k] * known_sigma * known_sigma < 1.0) continue;
    const Vector3d e = eigen.eigenvectors().col(k);
    out.mean += e * (e.dot(right) / eigen.eigenvalues()[k]);
    told += e * e.transpose();
  }
  for (int k = 0; k < 3; ++k) out.known[static_cast<size_t>(k)] = told(k, k) > 0.5;
  const double gain = misfit.dot(weight.solve(misfit)) - (misfit - normals * out.mean).dot(weight.solve(misfit - normals * out.mean));
  int concerned = 0, better = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double part = normals.row(i).dot(out.mean);
    if (std::abs(part) < 0.5 * least_shift && std::abs(misfit[i]) < 0.5 * least_shift) continue;
    ++concerned;
    if (std::abs(misfit[i] - part) < 0.5 * std::abs(misfit[i])) ++better;
  }
  out.shifted = out.mean.norm() > least_shift && gain > shift_significance && better >= majority * concerned;
  return out;
}

}  // namespace swath::calib
