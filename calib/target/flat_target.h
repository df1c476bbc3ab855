// SPDX-License-Identifier: GPL-3.0-or-later
// The calibration flight over a flat roof, after Brandalize: how far each line has displaced the roof, what each pass shows of roll, pitch
// and heading, of the range and of the scan's scale, and whether the values in force should be changed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/target/target_readings.h"
#include "calib/terms.h"
#include "core/config/option.h"
#include "core/records/sensor.h"
#include "core/report.h"
#include "georef/shot_stream.h"
#include "io/vector/control.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct FlatTargetOptions {
  std::string target;
  core::Radians search = core::degrees(0.7);
  int rounds = 6;
  std::optional<core::Radians> tolerance;
  double tolerance_sigmas = 2.0;
  double nadir_share = 0.35, edge_share = 0.5;
  core::Metres stands_out{3.0}, shortest_side{10.0};
  double single_growth = 0.25, single_growth_sigma = 0.25;
};

template <class V>
void describe(FlatTargetOptions& o, V& v) {
  v.option("target", o.target, "Surveyed target to use; empty: the largest one, or without any the largest flat roof in the data.");
  v.option("search", o.search, core::within(0.05 * core::degree, 5.0 * core::degree),
           "How far the mounting may be wrong at the start, about each axis.");
  v.option("rounds", o.rounds, core::within(1, 20), "Most rounds of measuring the target, correcting and measuring again.");
  v.option("tolerance", o.tolerance, core::at_least(0),
           "An angle is replaced where it differs by more than this; without a value: tolerance_sigmas.", "Brandalize");
  v.option("tolerance_sigmas", o.tolerance_sigmas, core::at_least(0), "The tolerance in sigmas of the mean reading.");
  v.option("nadir_share", o.nadir_share, core::within(0.05, 0.9), "A target within this share of the half swath counts as at nadir.");
  v.option("edge_share", o.edge_share, core::within(0.1, 1.0), "A target beyond this share of the half swath counts as at the edge.");
  v.option("stands_out", o.stands_out, core::above(0), "A roof found in the data stands this far above its surroundings.");
  v.option("shortest_side", o.shortest_side, core::above(0), "Least length of the sides of a roof found in the data.");
  v.option("single_growth", o.single_growth, core::within(-0.5, 0.5),
           "Scanners with one return per pulse: growth of the roof at each edge, share of the footprint.");
  v.option("single_growth_sigma", o.single_growth_sigma, core::within(0.0, 1.0), "How well that share is known.");
  v.check(o.nadir_share < o.edge_share, "nadir_share must be below edge_share");
}

/// One angle, with everything that led to its new value. rad.
struct TargetAngle {
  Parameter parameter = boresight_roll;
  bool determined = false;
  double present = 0.0;           ///< in force before
  std::vector<Reading> readings;  ///< `value`: the boresight angle that the reading speaks for
  double mean = 0.0, own = 0.0, scatter = 0.0, sigma = 0.0;
  double tolerance = 0.0;
  bool beyond = false;          ///< mean and present differ by more than the tolerance
  double value = 0.0;           ///< new value: the mean where `beyond`, else the present one
  bool of_two_heights = false;  ///< the mean is that of angle and lever arm distinguished by two flying heights
};

/// One line's part.
struct TargetLine {
  int line = 0;
  std::uint32_t kept_one_in = 1;
  TargetView before, after;  ///< with the calibration in force, and with what was found
  bool measured = false;     ///< seen, and part of the readings
  TargetRole role = TargetRole::nadir;
  Eigen::Vector3d target{0, 0, 0};  ///< from scanner to target, body: forward, right, down, m
  double scan_angle = 0.0;          ///< under which the target's centre is seen, rad
  /// Of `before`, along, across, up: with trajectory, survey and calibration values held. Of an unsurveyed roof: relative to all lines.
  Eigen::Vector3d sigma{0, 0, 0};
};

struct FlatTarget {
  bool done = false;  ///< the target was found and seen
  RoofTarget target;
  std::vector<TargetLine> lines;
  TargetAngle roll, pitch, heading;
  bool range_determined = false;
  double range_present = 0.0, range_mean = 0.0, range_sigma = 0.0;  ///< range offset, m
  std::vector<Reading> range_readings;                              ///< `value`: range offset, m
  JointTarget joint;                                                ///< of the last round: what is left, all parameters at once
  double scan_scale = 1.0, scan_scale_sigma = 0.0;                  ///< by widths and places of the target
  core::Calibration calibration;                                    ///< new values where beyond the tolerance
  core::Calibration measured;                                       ///< the mean readings themselves
  std::vector<std::string> findings;                                ///< in words
  int rounds = 0;
  std::uint64_t returns = 0;
};

/// Reads the stream once (twice without survey). `control`: of all targets; corners with use `control` count.
FlatTarget analyse_flat_target(const ShotStream& shots, const core::Scanner& scanner, const core::Calibration& calibration,
                               const core::SensorSigma& sigma, const trajectory::Trajectory& trajectory,
                               const TrajectoryCovariance& trajectory_covariance, const std::vector<io::ControlPoint>& control,
                               const FlatTargetOptions& options, core::Tally& tally);

}  // namespace swath::calib
