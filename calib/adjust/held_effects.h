// SPDX-License-Identifier: GPL-3.0-or-later
// What calibration values that are held, and yet uncertain, do to what is adjusted.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/adjust/adjust_rounds.h"
#include "core/records/sensor.h"

namespace swath::calib {

/// Held values with a sigma, and what the unknowns would be moved by if one of them were one sigma larger.
struct HeldEffects {
  std::vector<Parameter> parameters;  ///< rising
  Eigen::VectorXd sigma;              ///< of each, m, rad, s or none
  Eigen::MatrixXd effect;             ///< unknowns (calibration values, corrections) x parameters
  Eigen::MatrixXd correlation;        ///< between the parameters

  /// Covariance of some unknowns by what is held.
  Eigen::MatrixXd covariance(const std::vector<int>& unknowns) const;
};

/// `rounds` after run(). `sensor`: sigmas of the held values and their correlations. A value that is the same turn as an estimated one is
/// left out: it is a matter of names.
HeldEffects effects_of_held(const TieProblem& problem, const AdjustRounds& rounds, const core::SensorSigma& sensor);

/// Correlation of two calibration values as `sensor` states it; 0 where it states none.
double correlation_of(const core::SensorSigma& sensor, Parameter a, Parameter b);

}  // namespace swath::calib
