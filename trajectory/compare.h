// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory against a better known one: errors, their statistics, and whether the printed sigmas are true.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "core/config/value.h"
#include "core/records/trajectory_data.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// Trajectory minus truth at the trajectory's own records. Vectors of one length; the sigmas are empty where the trajectory has none.
struct TrajectoryErrors {
  std::vector<double> time;                                     ///< GPS time, s
  std::vector<Eigen::Vector3d> position, attitude;              ///< north east down, m; roll pitch heading, rad
  std::vector<Eigen::Vector3d> position_sigma, attitude_sigma;  ///< of the trajectory, the same axes
  std::size_t outside = 0;                                      ///< records that the truth does not cover

  std::size_t size() const { return time.size(); }
};

/// Truth is interpolated to the time of each record (Trajectory::pose_at); axes are those of the true position; angles are differences
/// brought to (-pi, pi].
TrajectoryErrors errors_against(const core::TrajectoryData& trajectory, const Trajectory& truth);

/// Of one component; m or rad.
struct ErrorMeasures {
  double mean = 0.0, rms = 0.0;
  double largest = 0.0;     ///< of |error|
  double over_sigma = 0.0;  ///< rms of error / sigma, 1 where the sigmas are true; 0 where there are none
};

struct Comparison {
  std::size_t compared = 0;
  std::array<ErrorMeasures, 6> component;  ///< north, east, down, roll, pitch, heading

  static constexpr std::array<std::string_view, 6> names{"north", "east", "down", "roll", "pitch", "heading"};
  /// {"compared": n, "north": {"mean_m", "rms_m", "max_m", "error_over_sigma"}, ... "roll": {"mean_arcsec", ...}}.
  core::Value value() const;
};

/// Measures of the errors within spans of time; no spans: of all.
Comparison compare(const TrajectoryErrors& errors, const std::vector<Span>& within = {});

}  // namespace swath::trajectory
