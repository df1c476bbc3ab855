// SPDX-License-Identifier: GPL-3.0-or-later
// Corrections to the trajectory as unknowns: for each line a constant, a drift, or values at knots, and what is known of them beforehand.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/correction_chain.h"
#include "calib/ties/tie_set.h"

namespace swath::calib {

/// Covariance of the trajectory's errors at n instants: 6n x 6n, per instant north, east, down (m), roll, pitch, heading (rad).
using ErrorCovariance = std::function<Eigen::MatrixXd(const std::vector<double>& times)>;
/// Errors of one correlation time at all instants, independent between the six: the stated prior.
ErrorCovariance stated_covariance(const CorrectionOptions& options);

/// North, east, down (m), roll, pitch, heading (rad).
using Correction = Eigen::Matrix<double, 6, 1>;

/// Unknowns that may all be correlated with all: the work grows with the cube of their number. More are chained line by line, where that
/// makes knots narrower.
constexpr int max_together = 1500;

/// The unknowns of all lines in one vector: line by line the position's knots (north, east, down each), then the attitude's (roll, pitch,
/// heading each); after all of them, where the lines are chained, the lines' trends, which no observation touches.
///
/// Up to `max_together` unknowns have the covariance as given, all with all. Of more, where all parts are splines, each line's knots are a
/// Markov chain about its trend (calib/adjust/correction_chain.h), and only the trends are correlated from line to line.
class CorrectionKnots {
 public:
  /// `latency` is added to the lines' times. The prior of shifts and drifts is that of the least-squares fit of such a curve to errors at
  /// the knots that a spline would have. `scales_apart`: how the covariance shares the errors out among the time scales is a guess (sigmas
  /// with a correlation time), so that each scale has a factor of its own to be estimated.
  CorrectionKnots(const std::vector<TieLine>& lines, double latency, const CorrectionOptions& options, const ErrorCovariance& covariance,
                  bool scales_apart = false);

  /// Corrections and trends.
  int size() const { return size_ + trends_; }
  int corrections() const { return size_; }
  bool is_chained() const { return chains_.has_value(); }
  /// The node of each unknown, `globals` others counted before them: one node for all, or one per knot and trend.
  std::vector<int> nodes(int globals) const;
  /// Time between knots, s: as stated, or wider to keep options.most.
  double spacing() const { return spacing_; }
  /// Which three unknowns act at an instant, and by how much; up to two threes each.
  struct Weights {
    int count = 0;
    std::array<int, 2> first{};  ///< number of the first of the three unknowns
    std::array<double, 2> weight{};
  };
  Weights position(size_t line, double t) const { return weights(lines_[line].position, t); }
  Weights attitude(size_t line, double t) const { return weights(lines_[line].attitude, t); }
  /// The correction from the unknowns' values.
  Correction at(size_t line, double t, const Eigen::VectorXd& unknowns) const;
  /// 6 x (up to 12) matrix of its derivatives as columns with their numbers: for variances.
  Eigen::MatrixXd derivatives(size_t line, double t, std::vector<int>& numbers) const;

  /// Times at which the line's corrections are given: the finer of its two sets of knots, or its two ends.
  const std::vector<double>& times(size_t line) const { return lines_[line].given; }
  bool is_position(int unknown) const { return is_position_[static_cast<size_t>(unknown)]; }

  /// Not chained: the covariance as given, and its inverse.
  const Eigen::MatrixXd& covariance() const { return covariance_; }
  const Eigen::MatrixXd& information() const { return information_; }
  /// Both with sigmas of position and attitude multiplied by factors.
  Eigen::MatrixXd information(const ScaleFactors& position, const ScaleFactors& attitude) const;
  Eigen::MatrixXd covariance(const ScaleFactors& position, const ScaleFactors& attitude) const;
  /// What is known beforehand, added to a matrix with `first` others before it.
  void add_information(const ScaleFactors& position, const ScaleFactors& attitude, int first, TieMatrix& into) const;
  /// Covariance of some unknowns of derivatives(), of one line and instant; the factors as in information().
  using PriorOf = std::function<Eigen::MatrixXd(const std::vector<int>&)>;
  PriorOf prior(const ScaleFactors& position, const ScaleFactors& attitude) const;
  /// Mean square over a part's unknowns of one scale of the prior (all: of the whole), m^2 or rad^2; 0 where there are none.
  double mean_square(bool position, std::optional<CorrectionScale> scale) const;
  bool scales_apart() const { return scales_apart_; }
  /// Not chained: what the unknowns of a part hold of a scale: orthonormal columns, each of one line and component; line_mean and
  /// line_drift alone. A unit of such a column is the size of the line's knots together.
  const Eigen::MatrixXd& modes(bool position, CorrectionScale scale) const { return modes_[position ? 0 : 1][scale]; }
  const CorrectionChains& chains() const { return *chains_; }
  /// Columns: what one metre north, east, down common to all lines is in the unknowns.
  Eigen::MatrixXd common_shift() const;

 private:
  struct Knots {
    int first = 0;             // number of the first unknown
    std::vector<double> time;  // empty: none; one: a constant
  };
  struct Line {
    Knots position, attitude;
    std::vector<double> given, grid;  // instants at which corrections are given; of a spline's knots
  };
  static Weights weights(const Knots& knots, double t);
  void place_lines(const std::vector<TieLine>& lines, double latency, const CorrectionOptions& options);
  void make_dense(const CorrectionOptions& options, const ErrorCovariance& covariance);
  void make_chains(const ErrorCovariance& covariance);
  ChainPlaces chain_places(const Line& line, bool trend);
  void make_modes();
  // F A F, F = the factors' matrix: `factor` by scale for each part.
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& A, const std::array<ScaleFactors, 2>& factor) const;

  std::vector<Line> lines_;
  std::vector<bool> is_position_;
  int size_ = 0, trends_ = 0;  // corrections; unknowns of trends after them
  double spacing_ = 0.0;
  bool scales_apart_ = false;
  Eigen::MatrixXd covariance_, information_;
  std::array<std::array<Eigen::MatrixXd, 2>, 2> modes_;  // by part, by scale
  std::optional<CorrectionChains> chains_;
  struct KnotOf {
    size_t line = 0, knot = 0, component = 0;
  };
  std::vector<KnotOf> knot_of_;  // of each correction; chained alone
};

}  // namespace swath::calib
