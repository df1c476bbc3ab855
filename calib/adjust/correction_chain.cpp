// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the chain's information: Rue & Held, "Gaussian Markov Random Fields" (2005), 1.2: the sum over the steps of J^T W^-1 J. The
// trend is an unknown of its own, x - G s = y with G = (1, place): a chain alone forgets what the knots of a line have in common, and a
// mean or drift as a condition on all knots would fill the line's part of the matrix.
// Deviations: what is left about the trend is correlated beyond neighbours as a Markov chain's, and trend and rest are independent of
// each other. The chain's own mean and drift are taken off the trend's covariance.
#include "calib/adjust/correction_chain.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index least_knots = 4;    // of a line with a trend
constexpr double independent_share = 1e-6;  // of each variance, independent: what arithmetic cannot keep apart
constexpr double least_trend = 1e-2;  // of a trend's variance: what is left of it at least when the chain's is taken off
constexpr double most_stretch = 10.0;  // of the chain's variance

/// Eigenvalues of `m` in units of `sigma`, not below `least`, brought back.
MatrixXd not_below(const MatrixXd& m, const VectorXd& sigma, double least) {
  const VectorXd inverse = sigma.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(inverse.asDiagonal() * m * inverse.asDiagonal());
  const MatrixXd side = sigma.asDiagonal() * solver.eigenvectors();
  return side * solver.eigenvalues().cwiseMax(least).asDiagonal() * side.transpose();
}

/// What is left of a line's covariance C about its trends: C less its projection on B (orthonormal), block by block.
class Remainder {
 public:
  Remainder(const MatrixXd& C, const MatrixXd& B, Index q) : C_(C), B_(B), CB_(C * B), M_(B.transpose() * CB_), q_(q) {}
  MatrixXd block(Index i, Index j) const {
    const auto B_i = B_.middleRows(i * q_, q_), B_j = B_.middleRows(j * q_, q_);
    return C_.block(i * q_, j * q_, q_, q_) - B_i * CB_.middleRows(j * q_, q_).transpose() -
           CB_.middleRows(i * q_, q_) * B_j.transpose() + B_i * M_ * B_j.transpose();
  }
  const MatrixXd& of_trends() const { return M_; }

 private:
  const MatrixXd &C_, &B_;
  MatrixXd CB_, M_;
  Index q_;
};

MatrixXd symmetric(const MatrixXd& m) { return 0.5 * (m + m.transpose()); }

/// A of y(k + 1) = A y(k) + w, and w's covariance.
struct Step {
  MatrixXd A, W;
};
Step step_of(const LineChain& line, size_t k) {
  Step out;
  out.A = line.at[k].ldlt().solve(line.next[k].transpose()).transpose();
  out.W = symmetric(line.at[k + 1] - out.A * line.next[k].transpose());
  out.W.diagonal() += independent_share * line.at[k + 1].diagonal();
  return out;
}

/// The chain's covariance between all its knots.
MatrixXd whole_of(const LineChain& line) {
  const auto n = static_cast<Index>(line.at.size()), q = line.at.front().rows();
  MatrixXd out(n * q, n * q);
  for (Index k = 0; k < n; ++k) {
    out.block(k * q, k * q, q, q) = line.at[static_cast<size_t>(k)];
    if (k == 0) continue;
    const Step s = step_of(line, static_cast<size_t>(k) - 1);
    out.block(k * q, 0, q, k * q) = s.A * out.block((k - 1) * q, 0, q, k * q);
    out.block(0, k * q, k * q, q) = out.block(k * q, 0, q, k * q).transpose();
  }
  return out;
}

/// Columns: the mean of each component over the knots, then its drift, of unit length.
MatrixXd trends_of(const std::vector<double>& place, Index q) {
  const auto n = static_cast<Index>(place.size());
  MatrixXd out = MatrixXd::Zero(n * q, 2 * q);
  double length = 0.0;
  for (const double p : place) length += p * p;
  for (Index k = 0; k < n; ++k)
    for (Index c = 0; c < q; ++c) {
      out(k * q + c, c) = 1.0 / std::sqrt(static_cast<double>(n));
      out(k * q + c, q + c) = place[static_cast<size_t>(k)] / std::sqrt(length);
    }
  return out;
}

}  // namespace

LineChain chain_of(const MatrixXd& C, Index q) {
  const Index n = C.rows() / q;
  LineChain out;
  if (n < least_knots) {
    for (Index k = 0; k < n; ++k) {
      out.at.push_back(C.block(k * q, k * q, q, q));
      if (k + 1 < n) out.next.push_back(C.block((k + 1) * q, k * q, q, q));
    }
    return out;
  }
  for (Index k = 0; k < n; ++k) out.place.push_back(2.0 * static_cast<double>(k) / static_cast<double>(n - 1) - 1.0);
  const MatrixXd B = trends_of(out.place, q);
  const Remainder left(C, B, q);
  VectorXd wanted = VectorXd::Zero(q), made = wanted;
  for (Index k = 0; k < n; ++k) {
    out.at.push_back(symmetric(left.block(k, k)));
    wanted += out.at.back().diagonal();
    out.at.back().diagonal() += independent_share * C.block(k * q, k * q, q, q).diagonal();
    if (k + 1 < n) out.next.push_back(left.block(k + 1, k));
  }
  // As much about a line's trend as there is, component by component.
  MatrixXd whole = whole_of(out);
  const Remainder of_chain(whole, B, q);
  for (Index k = 0; k < n; ++k) made += of_chain.block(k, k).diagonal();
  const VectorXd stretch = wanted.cwiseQuotient(made).cwiseMax(1.0 / most_stretch).cwiseMin(most_stretch).cwiseSqrt();
  for (MatrixXd& m : out.at) m = stretch.asDiagonal() * m * stretch.asDiagonal();
  for (MatrixXd& m : out.next) m = stretch.asDiagonal() * m * stretch.asDiagonal();
  // From unit length to the unit of the mean and of the drift from the middle to the end.
  VectorXd unit(2 * q);
  unit << VectorXd::Constant(q, B(0, 0)), VectorXd::Constant(q, -B(0, q));
  const VectorXd both = stretch.replicate(2, 1);
  const MatrixXd of_line = unit.asDiagonal() * left.of_trends() * unit.asDiagonal();
  const MatrixXd own = (unit.cwiseProduct(both)).asDiagonal() * of_chain.of_trends() * (unit.cwiseProduct(both)).asDiagonal();
  out.trend = not_below(symmetric(of_line - own), of_line.diagonal().cwiseSqrt(), least_trend);
  return out;
}

MatrixXd root_of(const MatrixXd& covariance) {
  const VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(sigma.cwiseInverse().asDiagonal() * covariance *
                                                       sigma.cwiseInverse().asDiagonal());
  return sigma.asDiagonal() * solver.eigenvectors() * solver.eigenvalues().cwiseMax(independent_share).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

CorrectionChains::CorrectionChains(std::vector<LineChain> lines, std::vector<ChainPlaces> places, const MatrixXd& trends,
                                   std::vector<bool> is_position)
    : lines_(std::move(lines)), places_(std::move(places)), is_position_(std::move(is_position)) {
  const auto size = 2 * static_cast<Index>(components());
  MatrixXd back = MatrixXd::Zero(trends.rows(), trends.rows());  // inverse roots of the trends' covariances
  int at = 0;
  for (const LineChain& line : lines_) {
    trend_at_.push_back(line.place.empty() ? -1 : at);
    if (line.place.empty()) continue;
    back.block(at, at, size, size) = root_of(line.trend).inverse();
    at += static_cast<int>(size);
  }
  MatrixXd correlation = trends;
  correlation.diagonal().array() += independent_share;
  trend_information_ = back.transpose() * correlation.llt().solve(back);
}

VectorXd CorrectionChains::factor_of(const Factors& factors, CorrectionScale scale) const {
  VectorXd out(static_cast<Index>(components()));
  for (size_t c = 0; c < components(); ++c) out[static_cast<Index>(c)] = factors[is_position_[c] ? 0 : 1][scale];
  return out;
}

VectorXd CorrectionChains::trend_factor(const Factors& factors) const {
  VectorXd out(2 * static_cast<Index>(components()));
  out << factor_of(factors, line_mean), factor_of(factors, line_drift);
  return out;
}

template <class Visit>
void CorrectionChains::each_step(const Factors& factors, const Visit& visit) const {
  const auto q = static_cast<Index>(components());
  const VectorXd f = factor_of(factors, within_line), back = f.cwiseInverse();
  for (size_t l = 0; l < lines_.size(); ++l) {
    const LineChain& line = lines_[l];
    const ChainPlaces& places = places_[l];
    const Index trend = line.place.empty() ? 0 : 2 * q;
    const auto G = [&](size_t k) {
      MatrixXd out = MatrixXd::Zero(q, trend);
      if (trend == 0) return out;
      out.leftCols(q).setIdentity();
      out.rightCols(q).diagonal().setConstant(line.place[k]);
      return out;
    };
    for (size_t k = 0; k < line.at.size(); ++k) {
      std::vector<int> numbers;
      MatrixXd J(q, (k == 0 ? q : 2 * q) + trend), W;
      if (k == 0) {
        J << MatrixXd::Identity(q, q), -G(0);
        W = f.asDiagonal() * line.at[0] * f.asDiagonal();
      } else {
        const Step s = step_of(line, k - 1);
        const MatrixXd A = f.asDiagonal() * s.A * back.asDiagonal();
        J << -A, MatrixXd::Identity(q, q), A * G(k - 1) - G(k);
        W = f.asDiagonal() * s.W * f.asDiagonal();
        numbers = places.knot[k - 1];
      }
      numbers.insert(numbers.end(), places.knot[k].begin(), places.knot[k].end());
      numbers.insert(numbers.end(), places.trend.begin(), places.trend.end());
      visit(numbers, J, MatrixXd(W.llt().solve(MatrixXd::Identity(q, q))));
    }
  }
}

void CorrectionChains::add_information(const Factors& factors, int first, TieMatrix& into) const {
  const auto shifted = [first](std::vector<int> numbers) {
    for (int& n : numbers) n += first;
    return numbers;
  };
  each_step(factors, [&](const std::vector<int>& numbers, const MatrixXd& J, const MatrixXd& weight) {
    into.add(shifted(numbers), J.transpose() * weight * J);
  });
  const VectorXd back = trend_factor(factors).cwiseInverse();
  const Index size = back.size();
  for (size_t l = 0; l < lines_.size(); ++l)
    for (size_t k = 0; k <= l; ++k) {
      if (trend_at_[l] < 0 || trend_at_[k] < 0) continue;
      const MatrixXd block = back.asDiagonal() * trend_information_.block(trend_at_[l], trend_at_[k], size, size) * back.asDiagonal();
      if (l == k) {
        into.add(shifted(places_[l].trend), block);
        continue;
      }
      std::vector<int> both = places_[l].trend;
      both.insert(both.end(), places_[k].trend.begin(), places_[k].trend.end());
      MatrixXd M = MatrixXd::Zero(2 * size, 2 * size);
      M.topRightCorner(size, size) = block;
      M.bottomLeftCorner(size, size) = block.transpose();
      into.add(shifted(both), M);
    }
}

std::array<std::array<ScaleSums, 3>, 2> CorrectionChains::sums(const Factors& factors, const VectorXd& values, const TieInverse& inverse,
                                                               int first) const {
  std::array<std::array<ScaleSums, 3>, 2> out;
  const auto covariance = [&](std::vector<int> numbers) {
    for (int& n : numbers) n += first;
    return inverse.of(numbers);
  };
  const auto add = [&](size_t component, CorrectionScale scale, double squares, double freedom) {
    ScaleSums& s = out[is_position_[component] ? 0 : 1][scale];
    s.squares += squares;
    s.freedom += freedom;
  };
  each_step(factors, [&](const std::vector<int>& numbers, const MatrixXd& J, const MatrixXd& weight) {
    const VectorXd r = J * values(numbers), weighted = weight * r;
    const MatrixXd known = weight * (J * covariance(numbers) * J.transpose());
    for (size_t c = 0; c < components(); ++c) {
      const auto i = static_cast<Index>(c);
      add(c, within_line, r[i] * weighted[i], 1.0 - known(i, i));
    }
  });
  std::vector<int> numbers;
  for (const ChainPlaces& p : places_) numbers.insert(numbers.end(), p.trend.begin(), p.trend.end());
  if (numbers.empty()) return out;
  const VectorXd one_back = trend_factor(factors).cwiseInverse();
  const VectorXd back = one_back.replicate(static_cast<Index>(numbers.size()) / one_back.size(), 1);
  const MatrixXd information = back.asDiagonal() * trend_information_ * back.asDiagonal();
  const VectorXd s = values(numbers), weighted = information * s;
  const VectorXd known = information.cwiseProduct(covariance(numbers)).rowwise().sum();
  for (Index i = 0; i < s.size(); ++i) {
    const auto row = static_cast<size_t>(i % one_back.size());
    add(row % components(), row < components() ? line_mean : line_drift, s[i] * weighted[i], 1.0 - known[i]);
  }
  return out;
}

double CorrectionChains::covariance(const Factors& factors, size_t line, std::array<size_t, 2> knots,
                                    std::array<size_t, 2> components) const {
  const LineChain& l = lines_[line];
  if (knots[0] > knots[1]) return covariance(factors, line, {knots[1], knots[0]}, {components[1], components[0]});
  const auto a = static_cast<Index>(components[0]), b = static_cast<Index>(components[1]);
  const VectorXd f = factor_of(factors, within_line);
  double out = f[a] * f[b] * (knots[0] == knots[1] ? l.at[knots[0]](a, b) : l.next[knots[0]](b, a));
  if (l.place.empty()) return out;
  const VectorXd t = trend_factor(factors);
  const Index q = f.size();
  const double pa[] = {1.0, l.place[knots[0]]}, pb[] = {1.0, l.place[knots[1]]};
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 2; ++j) out += pa[i] * pb[j] * t[i * q + a] * t[j * q + b] * l.trend(i * q + a, j * q + b);
  return out;
}

double CorrectionChains::squares(bool position, CorrectionScale scale) const {
  double out = 0.0;
  const auto q = static_cast<Index>(components());
  for (const LineChain& line : lines_)
    for (size_t k = 0; k < line.at.size(); ++k)
      for (size_t c = 0; c < components(); ++c) {
        if (is_position_[c] != position) continue;
        const auto i = static_cast<Index>(c);
        if (scale == within_line)
          out += line.at[k](i, i);
        else if (!line.place.empty())
          out += scale == line_mean ? line.trend(i, i) : std::pow(line.place[k], 2) * line.trend(q + i, q + i);
      }
  return out;
}

}  // namespace swath::calib
