// SPDX-License-Identifier: GPL-3.0-or-later
// How well the start values of an adjustment are known: as the survey states in [sigma].
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/terms.h"
#include "core/records/sensor.h"
#include "georef/shot_geometry.h"

namespace swath::calib {

/// Sigma of a start value; infinite where it counts for nothing.
double apriori_of(const AprioriOptions& sigmas, Parameter p);

/// Those that a survey states in [sigma] or in its calibration file; AprioriOptions' own where it states none, or 0.
AprioriOptions start_sigmas(const core::SensorSigma& sensor);

/// Start values that the flight contradicts: what was found lies farther from them than `apriori` allows. `found`: less the start;
/// `formal`: sigma of what was found, the start counted. Departures over their sigmas, in the order given; 0 where there is no
/// contradiction.
Eigen::VectorXd contradicted(const Eigen::VectorXd& found, const Eigen::VectorXd& formal, const Eigen::VectorXd& apriori);

}  // namespace swath::calib
