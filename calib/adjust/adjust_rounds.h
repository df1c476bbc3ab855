// SPDX-License-Identifier: GPL-3.0-or-later
// The rounds of the adjustment: linearise, weigh, solve, estimate variances, look for gross errors, until nothing changes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/variance_components.h"

namespace swath::calib {

class AdjustRounds {
 public:
  /// All that is referred to must outlive this object. `apriori`: sigma of each global unknown's start value, infinite where free; `limit`:
  /// its largest useful sigma.
  AdjustRounds(const TieProblem& problem, const core::Calibration& start, const core::SensorSigma& noise, Eigen::VectorXd apriori,
               const Eigen::VectorXd& limit, const AdjustOptions& options);

  /// Runs to the end; the members below are then of the last linearisation.
  void run();

  TieState state;
  TieSelection use;
  SigmaFactors factors;
  double scale = 1.0;
  std::vector<double> before;  ///< of each group: mean distance from the planes at the start, planes refitted, m
  TiePass pass;
  std::vector<PlaneRest> rests;
  std::optional<Normals> normals;  ///< with what is known beforehand
  std::optional<TiePrior> prior;
  TieSolution solution;
  TieTests tests;
  ControlShift shift;
  Eigen::VectorXd contradiction;  ///< of each start value by the flight, in sigmas; it then counts for nothing. 0: none
  int rounds = 0;
  bool converged = false, snooping_full = false;

  const TieSystem& system() const { return *system_; }
  double surface() const { return factors.surface.factor * options_->components.surface_sigma.value; }
  TieNoise noise() const;

 private:
  void fit_planes();
  void set_roughness();
  /// Linearises at the state and solves.
  void solve_here(Inverse keep = Inverse::covariance);
  void sum_up(Inverse keep = Inverse::covariance);
  /// Returns whether the step and the changes of the variances were small.
  bool round(bool variances);
  void iterate(bool variances);
  bool snoop();
  /// Lets go of start values that the flight contradicts, before the variances make room for them.
  void release_contradicted();

  const TieProblem* problem_;
  const core::SensorSigma* stated_;
  const AdjustOptions* options_;
  core::Calibration start_;
  Eigen::VectorXd apriori_, information_, free_;  // of the global unknowns: sigmas, information, that of a free one
  std::unique_ptr<TieSystem> system_;
};

}  // namespace swath::calib
