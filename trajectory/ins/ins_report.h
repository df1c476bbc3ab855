// SPDX-License-Identifier: GPL-3.0-or-later
// From what the smoother found to numbers, series and warnings.
#pragma once

#include "core/records/smoother_series.h"
#include "trajectory/ins/alignment.h"
#include "trajectory/ins/ins_results.h"
#include "trajectory/ins/ins_smoother.h"

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
  double overstated = 1.0;  ///< times that the fixes' stated sigmas are too large
};

core::SmootherSeries series_of(const InsFindings& findings);
InsReport report_of(const InsFindings& findings, const core::SmootherSeries& series);

}  // namespace swath::trajectory
