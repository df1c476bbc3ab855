// SPDX-License-Identifier: GPL-3.0-or-later
// What is known beforehand of the corrections of many flight lines: of each line a trend (mean and drift) and a Markov chain about it from
// knot to knot, so that the information is sparse.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "calib/adjust/tie_matrix.h"

namespace swath::calib {

/// The time scales of a line's corrections: their mean, their drift along the line, and what is left within it.
enum CorrectionScale { line_mean = 0, line_drift = 1, within_line = 2 };
/// Factors on the prior sigmas of the corrections of one part (position or attitude), by CorrectionScale.
using ScaleFactors = std::array<double, 3>;

/// What a chain needs of the covariance of a line's corrections. Rows and columns: component after component.
struct LineCovariance {
  std::vector<Eigen::MatrixXd> at;    ///< of each knot
  std::vector<Eigen::MatrixXd> next;  ///< of the next knot (rows) with this one
  Eigen::MatrixXd by_trends;          ///< of all knots, times a mean and a drift of unit length of each component
};
/// `covariance`: of all components at some instants, instant after instant; it is asked for a few hundred instants at a time.
LineCovariance line_covariance(const std::vector<double>& times, Eigen::Index components,
                               const std::function<Eigen::MatrixXd(const std::vector<double>&)>& covariance);

/// One line: x(k) = mean + place(k) drift + y(k), y(k + 1) = A(k) y(k) + w(k).
struct LineChain {
  std::vector<double> place;          ///< of each knot, -1 at the line's start to 1 at its end; empty: no trend
  std::vector<Eigen::MatrixXd> at;    ///< covariance of y at each knot
  std::vector<Eigen::MatrixXd> next;  ///< of y at the next knot (rows) with y at this one
  Eigen::MatrixXd trend;              ///< covariance of the means, then of the drifts, of all components
  Eigen::MatrixXd own;                ///< the same of what y has of a mean and a drift
};
/// Knots evenly spaced. Means, drifts and what is left have the variances of the line's covariance, component by component, and
/// neighbouring knots nearly its correlation. A line of one knot has no trend.
LineChain chain_of(const LineCovariance& line);

/// Symmetric square root of a covariance scaled to correlations, times the sigmas: R R^T = covariance.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance);

/// Where a line's unknowns are in an adjustment.
struct ChainPlaces {
  std::vector<std::vector<int>> knot;  ///< of each knot, its components
  std::vector<int> trend;              ///< means, drifts; empty where the chain has none
};

/// Weighted squares of one component of variance, and their degrees of freedom.
struct ScaleSums {
  double squares = 0.0, freedom = 0.0;
};

class CorrectionChains {
 public:
  CorrectionChains() = default;
  /// `trends`: correlation of all lines' trends, line after line (those without left out), identity blocks on the diagonal.
  /// `is_position`: of each component.
  CorrectionChains(std::vector<LineChain> lines, std::vector<ChainPlaces> places, const Eigen::MatrixXd& trends,
                   std::vector<bool> is_position);

  /// By part: position, attitude.
  using Factors = std::array<ScaleFactors, 2>;
  /// Adds the information of knots and trends, their numbers counted from `first`.
  void add_information(const Factors& factors, int first, TieMatrix& into) const;
  /// Of values of all unknowns (counted from 0) and their covariance (numbers counted from `first`): by part and scale.
  std::array<std::array<ScaleSums, 3>, 2> sums(const Factors& factors, const Eigen::VectorXd& values, const TieInverse& inverse,
                                               int first) const;
  /// Covariance between two components of knots of one line, not farther apart than neighbours.
  double covariance(const Factors& factors, size_t line, std::array<size_t, 2> knots, std::array<size_t, 2> components) const;
  /// Sum over all knots of the variance on one scale, at factors of 1: of means, of drifts, of what is left.
  double squares(bool position, CorrectionScale scale) const;
  size_t components() const { return is_position_.size(); }

 private:
  Eigen::VectorXd factor_of(const Factors& factors, CorrectionScale scale) const;  // by component
  Eigen::VectorXd trend_factor(const Factors& factors) const;                      // by component of a trend
  // visit(numbers, J, weight): the residual J x of the first knot's y and of each step, with the inverse of its covariance.
  template <class Visit>
  void each_step(const Factors& factors, const Visit& visit) const;
  // visit(l, k, information of the trends of lines l >= k), where there is any.
  template <class Visit>
  void each_link(const Factors& factors, const Visit& visit) const;
  std::vector<int> both_trends(size_t l, size_t k) const;

  std::vector<LineChain> lines_;
  std::vector<ChainPlaces> places_;
  std::vector<bool> is_position_;
  std::vector<int> trend_at_;  // of each line, its first row among all trends; -1: none
  Eigen::MatrixXd trend_information_;
};

}  // namespace swath::calib
