// SPDX-License-Identifier: GPL-3.0-or-later
// With error links: between two of them the error is linear in time plus a bridge, a part of its own that is none at both and has what is
// missing to the marginal covariance in the middle:
//   e(t) = (1 - a) e_i + a e_{i+1} + b(t),  Cov(b(s), b(t)) = 4 min(a_s, a_t) (1 - max(a_s, a_t)) B
// (a Brownian bridge: white noise of rate makes one of attitude). Both parts are positive semi-definite as they stand.
// Without: e(t) = S(t) z(t), S S^T the covariance at t, the six of z independent of each other with exp(-|dt| / tau).
#include "trajectory/ins/error_model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

namespace swath::trajectory {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double ridge = 1e-9;  // of each variance: errors at instants very near each other are otherwise the same to all digits

/// The interval of a rising series that holds t, and where in it: 0 to 1.
struct Place {
  size_t interval = 0;
  double share = 0.0;
};
Place place_of(const std::vector<double>& series, double t) {
  const auto after = std::upper_bound(series.begin(), series.end(), t);
  const size_t next = std::clamp<size_t>(static_cast<size_t>(after - series.begin()), 1, series.size() - 1);
  return {next - 1, std::clamp((t - series[next - 1]) / (series[next] - series[next - 1]), 0.0, 1.0)};
}

Matrix6 pose_part(const core::CovarianceSeries::Matrix9& c) {
  Matrix6 out;
  out << c.topLeftCorner<3, 3>(), c.topRightCorner<3, 3>(), c.bottomLeftCorner<3, 3>(), c.bottomRightCorner<3, 3>();
  return out;
}

/// f of the eigenvalues of a symmetric matrix, in units of `sigma`, those below zero as zero.
template <class F>
Matrix6 by_eigenvalues(const Matrix6& m, const Vector6& sigma, F f) {
  const Vector6 scale = sigma.cwiseMax(1e-30).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scale.asDiagonal() * m * scale.asDiagonal());
  const Vector6 values = solver.eigenvalues().cwiseMax(0.0).unaryExpr(f);
  return solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
}

/// What the linear interpolation lacks in the middle of an interval between links.
Matrix6 missing(const core::TrajectoryData& data, size_t interval) {
  const core::ErrorLinks& l = data.errors;
  const size_t i = interval, j = interval + 1;
  const Matrix6 a = l.left(i) * l.right(i), b = l.left(j) * l.right(j), ab = l.left(i) * (l.link(j).transpose() * l.right(j));
  const Matrix6 linear = 0.25 * (a + b + ab + ab.transpose());
  const Matrix6 marginal = pose_part(data.covariance.at(0.5 * (l.time[i] + l.time[j])));
  const Vector6 sigma = marginal.diagonal().cwiseMax(0.0).cwiseSqrt();
  return sigma.asDiagonal() * by_eigenvalues(marginal - linear, sigma, [](double v) { return v; }) * sigma.asDiagonal();
}

}  // namespace

ErrorModel::ErrorModel(const core::TrajectoryData& data, const ErrorModelOptions& options) : data_(&data), options_(options) {}

bool ErrorModel::is_of_smoother() const { return data_->errors.size() > 1; }

MatrixXd ErrorModel::covariance(const std::vector<double>& times) const {
  MatrixXd out = is_of_smoother() ? of_links(times) : of_sigmas(times);
  out = 0.5 * (out + out.transpose()).eval();
  out.diagonal() *= 1 + ridge;
  return out;
}

MatrixXd ErrorModel::of_links(const std::vector<double>& times) const {
  const core::ErrorLinks& links = data_->errors;
  const auto n = static_cast<Index>(times.size());
  struct User {
    Index row;
    double weight;
  };
  std::map<size_t, std::vector<User>> users;        // of each link
  std::map<size_t, std::vector<User>> of_interval;  // weight: share
  for (Index p = 0; p < n; ++p) {
    const Place at = place_of(links.time, times[static_cast<size_t>(p)]);
    if (at.share < 1) users[at.interval].push_back({6 * p, 1 - at.share});
    if (at.share > 0) users[at.interval + 1].push_back({6 * p, at.share});
    if (at.share > 0 && at.share < 1) of_interval[at.interval].push_back({6 * p, at.share});
  }

  MatrixXd out = MatrixXd::Zero(6 * n, 6 * n);
  // All lefts up to the link at hand, each carried to it.
  MatrixXd carried(6 * static_cast<Index>(users.size()), links.states), products;
  std::vector<const std::vector<User>*> passed;
  size_t at = 0;
  for (const auto& [link, here] : users) {
    const auto rows = 6 * static_cast<Index>(passed.size());
    if (rows > 0) {
      MatrixXd way = links.link(++at);
      while (at < link) way = (links.link(++at) * way).eval();
      carried.topRows(rows) = (carried.topRows(rows) * way.transpose()).eval();
    }
    at = link;
    carried.middleRows<6>(rows) = links.left(link);
    passed.push_back(&here);
    products.noalias() = carried.topRows(rows + 6) * links.right(link);
    for (size_t k = 0; k < passed.size(); ++k) {
      const Matrix6 block = products.middleRows<6>(6 * static_cast<Index>(k));
      for (const User& a : *passed[k])
        for (const User& b : here) {
          out.block<6, 6>(a.row, b.row) += a.weight * b.weight * block;
          if (passed[k] != &here) out.block<6, 6>(b.row, a.row) += a.weight * b.weight * block.transpose();
        }
    }
  }
  if (data_->covariance.empty()) return out;
  for (const auto& [interval, inside] : of_interval) {
    const Matrix6 lacking = missing(*data_, interval);
    for (const User& a : inside)
      for (const User& b : inside)
        out.block<6, 6>(a.row, b.row) += 4 * std::min(a.weight, b.weight) * (1 - std::max(a.weight, b.weight)) * lacking;
  }
  return out;
}

ErrorModel::Matrix6 ErrorModel::root_at(double time) const {
  if (!data_->covariance.empty()) {
    const Matrix6 c = pose_part(data_->covariance.at(time));
    const Vector6 sigma = c.diagonal().cwiseMax(0.0).cwiseSqrt();
    return sigma.asDiagonal() * by_eigenvalues(c, sigma, [](double v) { return std::sqrt(v); });
  }
  Vector6 sigma;
  const ErrorModelOptions& o = options_;
  sigma << o.horizontal.value, o.horizontal.value, o.vertical.value, o.roll_pitch.value, o.roll_pitch.value, o.heading.value;
  if (data_->has_sigma()) {
    const Place at = data_->size() > 1 ? place_of(data_->time, time) : Place{};
    const size_t next = std::min(at.interval + 1, data_->size() - 1);
    const auto mix = [&](const std::vector<float>& c) {
      return (1 - at.share) * static_cast<double>(c[at.interval]) + at.share * static_cast<double>(c[next]);
    };
    const core::TrajectoryData& d = *data_;
    sigma << mix(d.sigma_north), mix(d.sigma_east), mix(d.sigma_down), mix(d.sigma_roll), mix(d.sigma_pitch), mix(d.sigma_heading);
  }
  return sigma.asDiagonal();
}

MatrixXd ErrorModel::of_sigmas(const std::vector<double>& times) const {
  const auto n = static_cast<Index>(times.size());
  Vector6 tau;
  tau.head<3>().setConstant(options_.position_correlation.value);
  tau.tail<3>() << options_.roll_correlation.value, options_.pitch_correlation.value, options_.heading_correlation.value;
  std::vector<Matrix6> roots;
  for (const double t : times) roots.push_back(root_at(t));
  MatrixXd out(6 * n, 6 * n);
  for (Index p = 0; p < n; ++p)
    for (Index q = 0; q < n; ++q) {
      const auto a = static_cast<size_t>(p), b = static_cast<size_t>(q);
      const Vector6 likeness = (-std::abs(times[a] - times[b]) * tau.cwiseInverse()).array().exp();
      out.block<6, 6>(6 * p, 6 * q) = roots[a] * likeness.asDiagonal() * roots[b].transpose();
    }
  return out;
}

}  // namespace swath::trajectory
