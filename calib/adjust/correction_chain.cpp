// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the chain's information: Rue & Held, "Gaussian Markov Random Fields" (2005), 1.2: the sum over the steps of J^T W^-1 J. The
// trend is an unknown of its own, x - G s = y with G = (1, place): a chain alone forgets what the knots of a line have in common, and a
// mean or drift as a condition on all knots would fill the line's part of the matrix.
// Deviations: what is left about the trend is correlated beyond neighbours as a Markov chain's, and independent of it. Its variance is
// kept, and so neighbours differ by more than they did: their difference has 1.4 to 1.55 times the variance on lines of 67 knots whose
// errors fall to 1/e in 15 s or more, 0.75 times on lines of four. The chain has a mean and a drift of its own, a tenth and a quarter of
// their variances where errors last as long as a line, two thirds where they last a tenth of it: so much of them is independent from line
// to line, and has the factor of what is within the line.
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

constexpr double independent_share = 1e-6;  // of each variance: what arithmetic cannot keep apart
constexpr double min_trend = 1e-2;          // of a trend's variance: what is left of it when the chain's own is taken off
constexpr double max_stretch = 10.0;        // of the chain's variance
constexpr double min_link = 1e-4;           // of two lines' trends, in units of their own information: less is none
constexpr double min_variance = 1e-24;
constexpr size_t tile = 128;  // instants

/// Eigenvalues of `m` in units of `sigma`, not below `least`, brought back.
MatrixXd not_below(const MatrixXd& m, const VectorXd& sigma, double least) {
  const VectorXd inverse = sigma.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(inverse.asDiagonal() * m * inverse.asDiagonal());
  const MatrixXd side = sigma.asDiagonal() * solver.eigenvectors();
  return side * solver.eigenvalues().cwiseMax(least).asDiagonal() * side.transpose();
}

/// Places of evenly spaced knots, -1 to 1.
std::vector<double> places_of(size_t knots) {
  std::vector<double> out;
  for (size_t k = 0; k < knots; ++k) out.push_back(knots > 1 ? 2.0 * static_cast<double>(k) / static_cast<double>(knots - 1) - 1.0 : 0.0);
  return out;
}

/// The mean and the drift of each component over the knots, of unit length: rows of one knot.
class Trends {
 public:
  Trends(size_t knots, Index q) : place_(places_of(knots)), q_(q), mean_(1.0 / std::sqrt(static_cast<double>(knots))) {
    double squares = 0.0;
    for (const double p : place_) squares += p * p;
    drift_ = squares > 0.0 ? 1.0 / std::sqrt(squares) : 0.0;
  }
  MatrixXd rows(size_t k) const {
    MatrixXd out = MatrixXd::Zero(q_, 2 * q_);
    out.leftCols(q_).diagonal().setConstant(mean_);
    out.rightCols(q_).diagonal().setConstant(drift_ * place_[k]);
    return out;
  }
  MatrixXd rows(size_t first, size_t last) const {
    MatrixXd out(static_cast<Index>(last - first) * q_, 2 * q_);
    for (size_t k = first; k < last; ++k) out.middleRows(static_cast<Index>(k - first) * q_, q_) = rows(k);
    return out;
  }
  /// From coefficients of these to the mean itself, and to the drift from the middle to the end.
  VectorXd unit() const {
    VectorXd out(2 * q_);
    out << VectorXd::Constant(q_, mean_), VectorXd::Constant(q_, drift_);
    return out;
  }
  const std::vector<double>& place() const { return place_; }

 private:
  std::vector<double> place_;
  Index q_;
  double mean_, drift_ = 0.0;
};

/// What is left of a line's covariance C when its trends B are taken off its corrections, block by block.
class Remainder {
 public:
  Remainder(const Trends& trends, const MatrixXd& CB, Index q) : trends_(trends), CB_(CB), M_(MatrixXd::Zero(2 * q, 2 * q)), q_(q) {
    for (size_t k = 0; k < trends.place().size(); ++k) M_ += trends.rows(k).transpose() * of_knot(k);
  }
  /// `C`: block of knots i and j.
  MatrixXd block(const MatrixXd& C, size_t i, size_t j) const {
    const MatrixXd B_i = trends_.rows(i), B_j = trends_.rows(j);
    return C - B_i * of_knot(j).transpose() - of_knot(i) * B_j.transpose() + B_i * M_ * B_j.transpose();
  }
  const MatrixXd& of_trends() const { return M_; }

 private:
  MatrixXd of_knot(size_t k) const { return CB_.middleRows(static_cast<Index>(k) * q_, q_); }
  const Trends& trends_;
  const MatrixXd& CB_;
  MatrixXd M_;
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

/// The chain's covariance between all its knots, times the trends.
MatrixXd chain_by_trends(const LineChain& line, const Trends& trends) {
  const size_t n = line.at.size();
  const Index q = line.at.front().rows();
  MatrixXd out(static_cast<Index>(n) * q, 2 * q), before, after = MatrixXd::Zero(q, 2 * q);
  const auto of = [&](size_t k) { return out.middleRows(static_cast<Index>(k) * q, q); };
  std::vector<MatrixXd> A;
  for (size_t k = 0; k + 1 < n; ++k) A.push_back(step_of(line, k).A);
  for (size_t k = 0; k < n; ++k) {
    before = k == 0 ? MatrixXd(line.at[0] * trends.rows(0)) : MatrixXd(A[k - 1] * before + line.at[k] * trends.rows(k));
    of(k) = before;
  }
  for (size_t k = n - 1; k-- > 0;) {
    after = (A[k].transpose() * (trends.rows(k + 1) + after)).eval();
    of(k) += line.at[k] * after;
  }
  return out;
}

}  // namespace

LineCovariance line_covariance(const std::vector<double>& times, Index q,
                               const std::function<MatrixXd(const std::vector<double>&)>& covariance) {
  LineCovariance out;
  const size_t n = times.size();
  const Trends trends(n, q);
  out.at.resize(n);
  out.next.resize(n - 1);
  out.by_trends = MatrixXd::Zero(static_cast<Index>(n) * q, 2 * q);
  const auto rows = [&](size_t first, size_t last) {
    return out.by_trends.middleRows(static_cast<Index>(first) * q, static_cast<Index>(last - first) * q);
  };
  for (size_t i = 0; i < n; i += tile)
    for (size_t j = 0; j <= i; j += tile) {
      const size_t i_end = std::min(n, i + tile), j_end = std::min(n, j + tile);
      std::vector<double> both(times.begin() + static_cast<std::ptrdiff_t>(i), times.begin() + static_cast<std::ptrdiff_t>(i_end));
      if (i != j)
        both.insert(both.end(), times.begin() + static_cast<std::ptrdiff_t>(j), times.begin() + static_cast<std::ptrdiff_t>(j_end));
      const MatrixXd whole = covariance(both);
      const Index own = static_cast<Index>(i_end - i) * q;
      const MatrixXd C = i == j ? whole : whole.topRightCorner(own, whole.cols() - own);
      rows(i, i_end) += C * trends.rows(j, j_end);
      if (i != j) rows(j, j_end) += C.transpose() * trends.rows(i, i_end);
      for (size_t k = i; k < i_end; ++k) {
        const auto at = static_cast<Index>(k - i) * q;
        if (i == j) out.at[k] = C.block(at, at, q, q);
        if (k > 0 && k - 1 >= j && k - 1 < j_end) out.next[k - 1] = C.block(at, static_cast<Index>(k - 1 - j) * q, q, q);
      }
    }
  return out;
}

LineChain chain_of(const LineCovariance& line) {
  LineChain out;
  const size_t n = line.at.size();
  const Index q = line.at.front().rows();
  if (n == 1) {
    out.at = line.at;
    return out;
  }
  const Trends trends(n, q);
  const Remainder left(trends, line.by_trends, q);
  out.place = trends.place();
  VectorXd wanted = VectorXd::Zero(q), made = wanted;
  for (size_t k = 0; k < n; ++k) {
    out.at.push_back(symmetric(left.block(line.at[k], k, k)));
    wanted += out.at.back().diagonal();
    out.at.back().diagonal() += independent_share * line.at[k].diagonal();
    if (k + 1 < n) out.next.push_back(left.block(line.next[k], k + 1, k));
  }
  // As much about a line's trend as there is, component by component.
  const MatrixXd by_trends = chain_by_trends(out, trends);
  const Remainder of_chain(trends, by_trends, q);
  for (size_t k = 0; k < n; ++k) made += of_chain.block(out.at[k], k, k).diagonal();
  const VectorXd stretch = wanted.cwiseQuotient(made.cwiseMax(min_variance)).cwiseMax(1.0 / max_stretch).cwiseMin(max_stretch).cwiseSqrt();
  for (MatrixXd& m : out.at) m = stretch.asDiagonal() * m * stretch.asDiagonal();
  for (MatrixXd& m : out.next) m = stretch.asDiagonal() * m * stretch.asDiagonal();
  const VectorXd unit = trends.unit(), stretched = unit.cwiseProduct(stretch.replicate(2, 1));
  MatrixXd of_line = unit.asDiagonal() * left.of_trends() * unit.asDiagonal();
  of_line.diagonal() += independent_share * line.at.front().diagonal().replicate(2, 1);
  out.own = symmetric(stretched.asDiagonal() * of_chain.of_trends() * stretched.asDiagonal());
  out.trend = not_below(symmetric(of_line) - out.own, of_line.diagonal().cwiseMax(min_variance).cwiseSqrt(), min_trend);
  return out;
}

MatrixXd root_of(const MatrixXd& covariance) {
  const VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal());
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
  MatrixXd K = correlation.llt().solve(MatrixXd::Identity(trends.rows(), trends.rows()));
  for (Index l = 0; l < K.rows(); l += size)
    for (Index k = 0; k < l; k += size) {
      if (K.block(l, k, size, size).cwiseAbs().maxCoeff() > min_link) continue;
      K.block(l, k, size, size).setZero();
      K.block(k, l, size, size).setZero();
    }
  trend_information_ = back.transpose() * K * back;
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
  each_link(factors, [&](size_t l, size_t k, const MatrixXd& block) {
    if (l == k) {
      into.add(shifted(places_[l].trend), block);
      return;
    }
    const Index size = block.rows();
    MatrixXd M = MatrixXd::Zero(2 * size, 2 * size);
    M.topRightCorner(size, size) = block;
    M.bottomLeftCorner(size, size) = block.transpose();
    into.add(shifted(both_trends(l, k)), M);
  });
}

std::vector<int> CorrectionChains::both_trends(size_t l, size_t k) const {
  std::vector<int> out = places_[l].trend;
  out.insert(out.end(), places_[k].trend.begin(), places_[k].trend.end());
  return out;
}

template <class Visit>
void CorrectionChains::each_link(const Factors& factors, const Visit& visit) const {
  const VectorXd back = trend_factor(factors).cwiseInverse();
  const Index size = back.size();
  for (size_t l = 0; l < lines_.size(); ++l)
    for (size_t k = 0; k <= l; ++k) {
      if (trend_at_[l] < 0 || trend_at_[k] < 0) continue;
      const MatrixXd block = trend_information_.block(trend_at_[l], trend_at_[k], size, size);
      if (!block.isZero(0.0)) visit(l, k, MatrixXd(back.asDiagonal() * block * back.asDiagonal()));
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
  const auto add_trend = [&](size_t row, double squares, double freedom) {
    add(row % components(), row < components() ? line_mean : line_drift, squares, freedom);
  };
  each_link(factors, [&](size_t l, size_t k, const MatrixXd& block) {
    const VectorXd a = values(places_[l].trend), b = values(places_[k].trend);
    const Index size = block.rows();
    const MatrixXd C = l == k ? covariance(places_[l].trend) : MatrixXd(covariance(both_trends(l, k)).topRightCorner(size, size));
    const MatrixXd known = block.cwiseProduct(C), squares = block.cwiseProduct(a * b.transpose());
    for (Index i = 0; i < size; ++i) {
      add_trend(static_cast<size_t>(i), squares.row(i).sum(), (l == k ? 1.0 : 0.0) - known.row(i).sum());
      if (l != k) add_trend(static_cast<size_t>(i), squares.col(i).sum(), -known.col(i).sum());
    }
  });
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
        const double p = line.place.empty() ? 0.0 : line.place[k] * line.place[k];
        const MatrixXd& own = line.own;
        if (scale == within_line)
          out += line.at[k](i, i) - (line.place.empty() ? 0.0 : own(i, i) + p * own(q + i, q + i));
        else if (!line.place.empty())
          out += scale == line_mean ? line.trend(i, i) + own(i, i) : p * (line.trend(q + i, q + i) + own(q + i, q + i));
      }
  return out;
}

}  // namespace swath::calib
