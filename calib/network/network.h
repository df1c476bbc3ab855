// SPDX-License-Identifier: GPL-3.0-or-later
// All instants of a flight in one sparse least-squares problem, solved by Gauss and Newton's method.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "calib/network/flight_states.h"
#include "calib/network/navigation_factors.h"
#include "trajectory/ins/ins_smoother.h"

namespace swath::calib {

/// The state of a flight's adjustment: estimates at all instants, the calibration's unknowns beside them.
class Network {
 public:
  /// `start`: per instant, near enough for a linearisation. `calibration`: number of its unknowns; they count from zero.
  Network(const trajectory::Problem& problem, std::vector<trajectory::Estimate> start, std::vector<trajectory::FixOutcome> outcomes,
          NavigationPrior prior, int calibration = 0);

  /// Other observations, linearised at the network's present estimates.
  using Others = std::function<void(NetworkNormals&)>;

  /// One linearisation and solution. Returns by how many sigmas the unknowns moved together, sqrt(x^T N x): no single one, and no linear
  /// function of them, moved by more of its own.
  double step(const Others& others = {});
  /// Steps until one moves by less than 0.05 sigma, or as rounding lets them.
  int solve(const Others& others = {}, int most = 10);

  const FlightStates& states() const { return states_; }
  const std::vector<trajectory::Estimate>& estimates() const { return estimates_; }
  const Eigen::VectorXd& calibration() const { return calibration_; }  ///< sum of its steps
  /// Of the last linearisation: weighted squares of all observations at its point.
  double squares() const { return squares_; }

  /// Observations of IMU and GNSS, linearised at the present estimates.
  void each(const NavigationVisit& visit) const { each_navigation(*problem_, states_, estimates_, outcomes_, prior_, visit); }

  /// The fixes' correlated error is an unknown of each instant, the last three of it.
  bool has_fix_error() const { return problem_->layout.fix >= 0; }

  /// Inverts the last linearisation on its pattern, once; before what follows.
  void invert() { factor_->invert(NodeFactor::Keep::inverse_alone); }
  /// Covariance over some nodes of states(), in their order.
  Eigen::MatrixXd covariance(const std::vector<int>& nodes) const { return factor_->covariance(nodes); }
  /// As the smoother states them.
  std::vector<trajectory::SmoothedNode> smoothed() const;
  Eigen::MatrixXd calibration_covariance() const;
  const NodeFactor& factor() const { return *factor_; }
  /// Solution of the last linearisation.
  const Eigen::VectorXd& last_step() const { return x_; }

 private:
  const trajectory::Problem* problem_;
  FlightStates states_;
  std::vector<trajectory::Estimate> estimates_;
  std::vector<trajectory::FixOutcome> outcomes_;
  NavigationPrior prior_;
  Eigen::VectorXd calibration_, x_;
  std::unique_ptr<NodeFactor> factor_;
  double squares_ = 0.0;
};

}  // namespace swath::calib
