// SPDX-License-Identifier: GPL-3.0-or-later
// How large the errors of ranges, angles, surfaces, trajectory and control really are, from the residuals.
#pragma once

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/snooping.h"

namespace swath::calib {

/// Factor on a stated sigma.
struct SigmaFactor {
  double factor = 1.0;
  double redundancy = 0.0;  ///< degrees of freedom that determine it
  bool estimated = false;
};
struct SigmaFactors {
  SigmaFactor range, angle, surface, control;
  /// Of the trajectory, by CorrectionScale; all alike where the knots do not hold the scales apart.
  std::array<SigmaFactor, 3> position, attitude;

  ScaleFactors of_position() const { return {position[0].factor, position[1].factor, position[2].factor}; }
  ScaleFactors of_attitude() const { return {attitude[0].factor, attitude[1].factor, attitude[2].factor}; }
};

/// Ranges and angles, from deviations of single returns within their groups. A component is known where its variance comes out to a
/// quarter of itself; angles that are not are held as stated. Steps are between a half and twice the sigma.
void update_white(const std::vector<GroupBlock>& blocks, const TieSelection& use, const ComponentOptions& options, SigmaFactors& factors);

/// Surfaces, trajectory and control, from a solution with covariance. `correction`: values of the corrections after the step. The factors
/// of trajectory and control are drawn to 1 by options.freedom degrees of freedom: factor^2 = (freedom + factor^2 Omega) / (freedom +
/// redundancy).
void update_correlated(const TieProblem& problem, const TieSystem& system, const TieSolution& solution, const TieTests& tests,
                       const TieSelection& use, const TiePrior& prior, const Eigen::VectorXd& correction, const ComponentOptions& options,
                       SigmaFactors& factors);

}  // namespace swath::calib
