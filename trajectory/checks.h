// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory judged as it is loaded: does its heading agree with its own track, are records missing or doubled, do the angles look right?
#pragma once

#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/records/trajectory_data.h"
#include "trajectory/motion_checks.h"

namespace swath::trajectory {

/// s: a step may exceed max_gap by the rounding of GPS times.
constexpr double time_rounding = 1e-6;

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

template <class V>
void describe(const Gap& r, V& v) {
  v.result("record", r.record, "Last record before the gap.");
  v.result("time_s", r.first, core::seconds().always(), "Its GPS time.");
  v.result("length_s", r.length, core::seconds().always(), "Length of the gap.");
}

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
  std::vector<std::string> turned;    ///< warnings of an attitude that does not follow the flight, those of `motion` among them
  std::vector<std::string> warnings;  ///< all, those of `turned` among them
};

template <class V>
void describe(const TrajectoryChecks& r, V& v) {
  using core::in_degrees;
  constexpr core::Form speed{"m/s", 2};
  v.result("records", r.records, core::plain().in_summary(), "Records.");
  v.result("rate_hz", r.rate, core::Form{"Hz", 1}.in_summary().always(), "Records per second, by the median step.");
  v.result("duplicates", r.duplicates, "Records whose time equals the one before.");
  v.result("backwards", r.backwards, "Records whose time is before the one before.");
  v.result("not_finite", r.not_finite, "Records with a value that is not a number.");
  v.tables("gaps", r.gaps, "Steps longer than max_gap.");
  v.result("straight_records", r.straight, "Records of straight level flight, by which heading and track are compared.");
  v.result("heading_minus_track_median_deg", core::to_degrees(r.crab_median), in_degrees(2).in_summary().always(),
           "Median of heading less track over these: wind, or a wrong heading.");
  v.result("heading_minus_track_spread_deg", core::to_degrees(r.crab_spread), in_degrees(2).always(),
           "Its robust spread about the median of each course.");
  v.result("speed_median_m_s", r.speed_median, speed.always(), "Median speed over the ground.");
  v.result("velocity_difference_m_s", r.velocity_difference, speed.always(),
           "Median of recorded less differenced velocity; 0 where none is recorded.");
  v.result("turning_s", r.motion.turning, core::seconds(1).always(), "Time in turns of more than 1 m/s2 across the track.");
  v.result("roll_per_bank", r.motion.roll_per_bank, core::plain(3).always(),
           "Slope of roll on the bank of a coordinated turn: 1 in flight.");
  v.result("pitch_per_bank", r.motion.pitch_per_bank, core::plain(3).always(), "The same of pitch: 0 in flight.");
  v.result("climb_per_recorded_climb", r.motion.climb_ratio, core::plain(3).always(),
           "Change of height per metre of climb by the recorded velocity; 0 where none is recorded.");
  v.result("warnings", r.warnings, core::plain().in_summary(), "What looks wrong, as sentences with figures.");
}

/// Takes any data, also data that Trajectory refuses. Thresholds of the warnings are named in the .cpp with their reasons.
TrajectoryChecks check_trajectory(const core::TrajectoryData& data, const CheckOptions& options = {});

}  // namespace swath::trajectory
