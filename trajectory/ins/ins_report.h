// SPDX-License-Identifier: GPL-3.0-or-later
// What the smoother found, as numbers, series and warnings.
#pragma once

#include "trajectory/clock/clock_offset.h"
#include "trajectory/ins/alignment.h"
#include "trajectory/ins/ins_smoother.h"
#include "trajectory/ins/smoother_series.h"

namespace swath::trajectory {

/// All that the report is made of.
struct InsFindings {
  const Problem& problem;
  const SmootherRun& run;
  const std::vector<FilterNode>& backward;
  const core::ImuErrorModel& spec;
  const Alignment& alignment;
  Eigen::Vector3d lever_arm;  ///< as stated, m
  double lever_arm_sigma;     ///< m
  const std::vector<Span>& standstills;
  int iterations;
  double unsettled;  ///< sigmas by which the last iteration still moved the trajectory; 0: it had settled
  const ClockFindings& clocks;
};

SmootherSeries series_of(const InsFindings& findings);
/// trajectory.json. Under "warnings": what a surveyor must look at, each with its numbers.
core::Value report_of(const InsFindings& findings, const SmootherSeries& series);

}  // namespace swath::trajectory
