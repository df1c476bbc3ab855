// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration flight cannot determine, in words, with the flight that would cure it.
#pragma once

#include <string>
#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/adjustment.h"
#include "calib/adjust/tie_normals.h"

namespace swath::calib {

/// Sigma up to which a value is graded good.
double limit_of(const LimitOptions& limits, Parameter p);

/// The geometry of a flight as its groups of returns show it.
struct FlightShape {
  int lines = 0;             ///< with returns on planes that another line sees too
  bool opposite = false;     ///< two lines that share planes fly opposite ways
  bool crossed = false;      ///< two lines that share planes cross
  bool beside = false;       ///< two parallel lines see common planes at angles well apart: swaths overlap at their sides
  bool two_heights = false;  ///< two lines that share planes fly at heights 1 : 1.2 or more
  bool control = false;
  int sloping = 0;      ///< planes steeper than 10 deg that two lines see
  int common = 0;       ///< planes that two lines see
  double widest = 0.0;  ///< largest scan angle on them, rad
};
FlightShape shape_of(const TieProblem& problem, const TieState& state, const std::vector<GroupBlock>& blocks);

/// What the numbers say of the global unknowns.
struct Separation {
  Eigen::MatrixXd information;  ///< of the unknowns by the data, corrections and control with their priors eliminated; start values not in
  Eigen::VectorXd formal;       ///< sigmas, start values in
  Eigen::VectorXd unaided;      ///< sigmas if all positions might be shifted by one common metre, start values in; empty: no such test
};
/// Condition number of a normal matrix scaled to ones on its diagonal; infinite where it is singular.
double scaled_condition(const Eigen::MatrixXd& information);

/// Findings on what is not determined, or coarse; those that refuse name the parameters whose values must not be delivered: the flight
/// brings less than limits.determined of what is known of them. `apriori`: infinite where the start counts for nothing.
std::vector<Finding> diagnose(const std::vector<Parameter>& globals, const Separation& separation, const Eigen::VectorXd& apriori,
                              const FlightShape& shape, const LimitOptions& limits);

}  // namespace swath::calib
