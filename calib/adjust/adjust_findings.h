// SPDX-License-Identifier: GPL-3.0-or-later
// What an adjustment found beside what the flight does not determine (calib/adjust/diagnosis.h), in words.
#pragma once

#include <vector>

#include "calib/adjust/adjust_rounds.h"
#include "calib/adjust/adjustment.h"
#include "calib/adjust/diagnosis.h"

namespace swath::calib {

/// A start value that the flight contradicts counts for nothing: its `apriori` becomes infinite.
void find_contradicted_starts(const TieProblem& problem, const AdjustRounds& rounds, Eigen::VectorXd& apriori,
                              std::vector<Finding>& findings);

/// Pairs of `globals` in out.correlation that are hardly separated, but for those that are `refused`.
void find_correlated(const std::vector<Parameter>& globals, const std::vector<Parameter>& refused, const FlightShape& shape,
                     Adjustment& out);

/// Knots much farther apart than options.spacing, which options.most asks for; `unknowns`: of all corrections.
void find_wide_knots(const CorrectionOptions& options, double spacing, int unknowns, Adjustment& out);

/// Where control, stated sigmas or the lines themselves do not fit, and whether the rounds came to an end.
void find_contradictions(const TieProblem& problem, const AdjustRounds& rounds, Adjustment& out);

}  // namespace swath::calib
