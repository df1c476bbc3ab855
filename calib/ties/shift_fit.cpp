// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters that are held and yet uncertain are "considered" (Schmidt, "Application of state-space methods to navigation problems", 1966):
// covariance = that of the others + G diag(their variances) G^T with G the others' change with them.
// Ceres was weighed: the model is linear, and what is not observable must be held one parameter at a time, which its solver does not offer.
#include "calib/ties/shift_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/statistics.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr int fewest_fit_squares = 4;
constexpr int iterations = 12;
constexpr double tukey = 4.685;
constexpr double loose = 0.2;  // rad: keeps the normal matrix regular

// Pairs per independent displacement.
double repetition(const std::vector<ObservedShift>& all) {
  std::map<std::uint64_t, std::set<std::uint64_t>> looks;
  for (const ObservedShift& x : all) {
    auto& of = looks[x.square];
    of.insert(x.look_a), of.insert(x.look_b);
  }
  double independent = 0.0;
  for (const auto& [square, of] : looks) independent += static_cast<double>(of.size()) - 1.0;
  return std::max(static_cast<double>(all.size()) / std::max(independent, 1.0), 1.0);
}

class Adjuster {
 public:
  Adjuster(std::vector<ObservedShift>& all, const LineErrors& errors) : all_(all) {
    for (const ObservedShift& x : all) column_.try_emplace(x.line_a, 0), column_.try_emplace(x.line_b, 0);
    for (auto& [line, at] : column_) at = columns_, columns_ += 6;
    prior_.resize(columns_);
    prior_.head<3>().setConstant(1.0 / (loose * loose));
    const auto weight = [](double sigma) { return 1.0 / std::max(sigma * sigma, 1e-18); };
    for (const auto& [line, at] : column_) {
      prior_.segment<2>(at).setConstant(weight(errors.horizontal));
      prior_[at + 2] = weight(errors.height);
      prior_.segment<3>(at + 3).setConstant(weight(errors.attitude));
    }
  }

  ShiftFit3 solve(const std::array<bool, 3>& held, const Vector3d& considered) {
    ShiftFit3 out;
    VectorXd solution = VectorXd::Zero(columns_);
    MatrixXd inverse;
    Matrix3d moved = Matrix3d::Zero();
    double factor = 1.0;
    for (ObservedShift& x : all_) x.weight = 1.0;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      MatrixXd N = prior_.asDiagonal();
      VectorXd g = VectorXd::Zero(columns_);
      for (const ObservedShift& x : all_) add(x, N, g);
      MatrixXd effect = MatrixXd::Zero(columns_, 3);  // of held angles on the right-hand side
      for (int k = 0; k < 3; ++k) {
        if (!held[static_cast<size_t>(k)]) continue;
        effect.col(k) = N.col(k) * considered[k];
        N.row(k).setZero(), N.col(k).setZero(), N(k, k) = 1.0, g[k] = 0.0;
      }
      for (int k = 0; k < 3; ++k)
        if (held[static_cast<size_t>(k)]) effect.row(k).setZero();
      inverse = N.ldlt().solve(MatrixXd::Identity(columns_, columns_));
      solution = inverse * g;
      moved = (inverse * effect).topRows<3>();
      factor = reweighted(solution);
    }
    out.error = solution.head<3>();
    out.covariance = factor * repetition(all_) * inverse.topLeftCorner<3, 3>() + moved * moved.transpose();
    out.sigma = out.covariance.diagonal().cwiseSqrt();
    double sum = 0.0, n = 0.0;
    for (const ObservedShift& x : all_)
      if (x.relief) sum += x.weight * residual(x, solution).head<2>().squaredNorm(), n += 2.0 * x.weight;
    out.rms = n > 0.0 ? std::sqrt(sum / n) : 0.0;
    return out;
  }

 private:
  Vector3d residual(const ObservedShift& x, const VectorXd& u) const {
    const int a = column_.at(x.line_a), b = column_.at(x.line_b);
    return x.shift - (x.by_b - x.by_a) * u.head<3>() - u.segment<3>(b) + u.segment<3>(a) - x.by_b * u.segment<3>(b + 3) +
           x.by_a * u.segment<3>(a + 3);
  }
  void add(const ObservedShift& x, MatrixXd& N, VectorXd& g) const {
    const int a = column_.at(x.line_a), b = column_.at(x.line_b);
    Eigen::Matrix<double, 3, 15> A;
    A << x.by_b - x.by_a, -Matrix3d::Identity(), -x.by_a, Matrix3d::Identity(), x.by_b;
    const int at[5] = {0, a, a + 3, b, b + 3};
    const Eigen::Matrix<double, 15, 3> AtP = x.weight * A.transpose() * x.covariance.inverse();
    const Eigen::Matrix<double, 15, 15> n = AtP * A;
    const Eigen::Matrix<double, 15, 1> r = AtP * x.shift;
    for (int i = 0; i < 5; ++i) {
      g.segment<3>(at[i]) += r.segment<3>(3 * i);
      for (int j = 0; j < 5; ++j) N.block<3, 3>(at[i], at[j]) += n.block<3, 3>(3 * i, 3 * j);
    }
  }
  // New weights; the variance factor, 1 or more.
  double reweighted(const VectorXd& solution) {
    std::vector<double> size;
    for (const ObservedShift& x : all_) {
      const Vector3d v = residual(x, solution);
      size.push_back(std::sqrt(v.dot(x.covariance.inverse() * v) / (x.relief ? 3.0 : 1.0)));
    }
    const double scale = std::max(core::mad_to_sigma * core::median(size, 1.0), 1.0);
    double sum = 0.0, weights = 0.0;
    for (size_t i = 0; i < all_.size(); ++i) {
      const double u = size[i] / (tukey * scale), rows = all_[i].relief ? 3.0 : 1.0;
      all_[i].weight = u < 1.0 ? (1 - u * u) * (1 - u * u) : 0.0;
      sum += all_[i].weight * rows * size[i] * size[i], weights += all_[i].weight * rows;
    }
    return std::max(sum / std::max(weights - 3.0, 1.0), 1.0);
  }

  std::vector<ObservedShift>& all_;
  std::map<int, int> column_;  // of a line: shift, then attitude
  int columns_ = 3;
  VectorXd prior_;
};

}  // namespace

ShiftFit3 fit_shifts(std::vector<ObservedShift>& all, const LineErrors& lines, double undetermined, double largest) {
  const auto squares = std::count_if(all.begin(), all.end(), [](const ObservedShift& x) { return x.relief; });
  std::array<bool, 3> held{all.empty(), squares < fewest_fit_squares, squares < fewest_fit_squares};
  Vector3d sigma = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Adjuster adjuster(all, lines);
  for (;;) {
    ShiftFit3 s = adjuster.solve(held, sigma.cwiseMin(largest));
    int worst = -1;
    for (int k = 0; k < 3; ++k) {
      if (held[static_cast<size_t>(k)]) continue;
      sigma[k] = s.sigma[k];
      if (s.sigma[k] > undetermined && (worst < 0 || s.sigma[k] > s.sigma[worst])) worst = k;
    }
    if (worst >= 0) {
      held[static_cast<size_t>(worst)] = true;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      s.determined[static_cast<size_t>(k)] = !held[static_cast<size_t>(k)];
      if (held[static_cast<size_t>(k)]) s.error[k] = 0.0, s.covariance.row(k).setZero(), s.covariance.col(k).setZero();
    }
    s.sigma = sigma;
    return s;
  }
}

}  // namespace swath::calib
