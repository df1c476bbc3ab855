// SPDX-License-Identifier: GPL-3.0-or-later
// The calibration flight over a flat roof, after Brandalize: how far each line has displaced the roof, what each pass shows of roll, pitch
// and heading, of the range and of the scan's scale, and whether the values in force should be changed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/target/flat_target_result.h"
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

/// Reads the stream once (twice without survey). `control`: of all targets; corners with use `control` count.
FlatTarget analyse_flat_target(const ShotStream& shots, const core::Scanner& scanner, const core::Calibration& calibration,
                               const core::SensorSigma& sigma, const trajectory::Trajectory& trajectory,
                               const TrajectoryCovariance& trajectory_covariance, const std::vector<io::ControlPoint>& control,
                               const FlatTargetOptions& options, core::Tally& tally);

}  // namespace swath::calib
