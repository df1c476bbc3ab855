// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/adjust_rounds.h"
#include "calib/adjust/adjustment.h"
#include "calib/adjust/held_effects.h"

namespace swath::calib {

/// What the rounds leave of the observations: counts, variance components, corrections, planes, residuals. Estimates and findings are not
/// touched. `held`: effects of the calibration values that were held, for the sigmas of the corrections.
void put_results(const TieProblem& problem, const AdjustRounds& rounds, const core::SensorSigma& noise, const AdjustOptions& options,
                 const HeldEffects& held, Adjustment& out);

}  // namespace swath::calib
