// SPDX-License-Identifier: GPL-3.0-or-later
// A sample of a flight's returns that shows whether its lines fit together: short stretches of lines that pass near one another.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "calib/geometry/geometry_pass.h"
#include "calib/terms.h"
#include "core/shot.h"
#include "georef/shot_stream.h"
#include "trajectory/fix_window.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Records of one flight line in one file, as they are known before any is read.
struct RecordedLine {
  int line = 0;
  double first = 0.0, last = 0.0;  ///< time as recorded, s
  std::uint64_t records = 0;
};

/// What is kept of a pass.
struct Stretch {
  size_t pass = 0;
  double first = 0.0, last = 0.0;  ///< time as recorded, s
  std::uint32_t every = 1;         ///< one in so many returns
  bool profile = false;            ///< long and thin: for the motion of the aircraft, not for the comparison of lines
};

struct SampleSize {
  double returns = 12000;      ///< of a stretch
  size_t most_stretches = 64;  ///< of the survey
  int sites = 3;               ///< places of a pair of passes that are compared
  size_t most_spots = 12;
};

struct SamplePlan {
  std::vector<Pass> passes;
  std::vector<Stretch> stretches;
  double cell = 0.0;                                              ///< side of a square that holds about ten returns of a stretch, m
  double covered = 0.0;                                           ///< share of the lines' time within the trajectory
  double nearest = std::numeric_limits<double>::infinity();       ///< distance of the two tracks nearest to one another, m
  size_t spots = 0, near_spots = 0;                               ///< asked for, and of those within reach of a track
  double nearest_spot = std::numeric_limits<double>::infinity();  ///< m, distance of one from a track
};

/// Records of one line in several files, beside one another (channels) or one after the other, become one; by time.
std::vector<RecordedLine> whole_lines(std::vector<RecordedLine> lines);

/// Stretches of passes that come nearer to one another than their swaths are wide, judged by the trajectory alone: no unit, sign or angle
/// of the laser takes part. `shift`: s, added to recorded times. `range`: m, of a usual return. `spots`: places, local, m, that are looked
/// at as well, each by the two passes nearest to it.
SamplePlan plan_sample(const std::vector<RecordedLine>& lines, const trajectory::Trajectory& trajectory,
                       const trajectory::LocalFrame& frame, double shift, double range, const SampleSize& size,
                       const std::vector<Eigen::Vector2d>& spots = {});

/// Numbers of the spots that the stretches of a plan may have seen: at most `most`, evenly among them.
std::vector<size_t> spots_seen(const SamplePlan& plan, double range, const std::vector<Eigen::Vector2d>& spots, size_t most);

/// The returns of a pass, last ones alone, by time.
struct PassSample {
  size_t pass = 0;
  core::Shots shots;
};
struct GeometrySample {
  std::vector<PassSample> surfaces;  ///< by pass
  std::vector<PassSample> profiles;
};

/// Samples of several plans of one flight, the stream read once. Which returns are kept depends on the plan and the records' numbers alone.
std::vector<GeometrySample> collect_samples(const std::vector<const SamplePlan*>& plans, const ShotStream& stream);

/// The records of a trajectory within the times of a sample (shifted), with a margin, s.
core::TrajectoryData cut_trajectory(const core::TrajectoryData& data, const SamplePlan& plan, double shift, double margin);

}  // namespace swath::calib
