// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory judged as it is loaded: does its heading agree with its own track, are records missing or doubled, do the angles look right?
#pragma once

#include <string>
#include <vector>

#include "core/option.h"
#include "core/trajectory_data.h"
#include "core/value.h"
#include "trajectory/motion_checks.h"

namespace swath::trajectory {

struct CheckOptions {
  core::Seconds max_gap{0.1};
  core::MetresPerSecond min_speed{10.0};
  core::Radians level_roll = core::degrees(5.0);
  core::RadiansPerSecond straight_rate{0.0087};
};

template <class V>
void describe(CheckOptions& o, V& v) {
  v.option("max_gap", o.max_gap, core::above(0.0), "A longer step between two records is a gap.");
  v.option("min_speed", o.min_speed, core::above(0.0), "Slower records have no track.");
  v.option("level_roll", o.level_roll, core::above(0.0), "Flight with more roll is a turn.");
  v.option("straight_rate", o.straight_rate, core::above(0.0), "Flight whose track turns faster is a turn.");
}

struct Gap {
  size_t record = 0;    ///< last record before it
  double first = 0.0;   ///< GPS time, s
  double length = 0.0;  ///< s
};

struct TrajectoryChecks {
  size_t records = 0;
  double rate = 0.0;      ///< 1 / median step, Hz
  size_t duplicates = 0;  ///< records whose time equals the one before
  size_t backwards = 0;   ///< records whose time is before the one before
  size_t not_finite = 0;  ///< records with a value that is no number
  std::vector<Gap> gaps;
  size_t straight = 0;               ///< records of straight level flight that the comparison used
  double crab_median = 0.0;          ///< median of heading - track over these, rad: wind, or a wrong heading
  double crab_spread = 0.0;          ///< 1.4826 median absolute deviation about the median of each course (30 deg), rad
  double crab_range = 0.0;           ///< the same about the mean of all: with the wind's change from course to course
  double speed_median = 0.0;         ///< m/s over the ground
  double velocity_difference = 0.0;  ///< median of |recorded - differenced horizontal velocity|, m/s; 0 where none is recorded
  MotionChecks motion;
  std::vector<std::string> warnings;  ///< those of `motion` among them

  core::Value value() const;
};

/// Takes any data, also data that Trajectory refuses. Thresholds of the warnings are named in the .cpp with their reasons.
TrajectoryChecks check_trajectory(const core::TrajectoryData& data, const CheckOptions& options = {});

}  // namespace swath::trajectory
