// SPDX-License-Identifier: GPL-3.0-or-later
// The pulses of one line as straight beams: where they pierce a roof's plane, at which heights most of them end, and where a roof among
// them lies roughly.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/target/roof_target.h"
#include "calib/terms.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Raw pulses of one line near the target: columns of one length, as recorded.
struct TargetPulses {
  std::vector<double> time, angle, forward;  ///< s, rad, x of the unit beam
  std::vector<double> first, last;           ///< ranges of the first and the last return, m
  std::vector<std::uint8_t> returns;         ///< recorded of the pulse

  size_t size() const { return time.size(); }
  /// Keeps every second pulse.
  void halve();
};

/// A pulse as a straight line in the local frame: its first return and the way per metre of range.
struct Beamline {
  Eigen::Vector3d first, back;  ///< m; none
  double further = 0.0;         ///< range of the last return beyond the first, m
  std::uint8_t returns = 1;
  size_t pulse = 0;
};

/// The same against a plane.
struct Pierced {
  Eigen::Vector2d place, slope;  ///< east, north, m; horizontal way per metre down
  double first, last;            ///< heights above the plane, m
  size_t pulse;
};

/// Pulses at times without trajectory are left out. In the target's frame.
std::vector<Beamline> beamlines(const TargetPulses& pulses, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                                const RoofTarget& target);

/// `plane`: up = plane . (1, east, north). Beams nearly level with it are left out.
std::vector<Pierced> pierce(const std::vector<Beamline>& beams, const Eigen::Vector3d& plane);

/// Heights above the plane, within `reach` m of it, at which many first returns lie: up to four, best first, m.
std::vector<double> frequent_heights(const std::vector<Pierced>& pulses, double reach);

/// First returns within this of the roof's plane count as on it while its tilt is not known, m: a roof 60 m wide tilts by 0.26 m under half
/// a degree of roll error.
constexpr double coarse_tolerance = 0.5;
constexpr std::uint32_t fewest_on_roof = 30;

/// Shift (east, north, `search` m and some at most) that puts the roof onto the most returns at its height and the fewest others. `score`:
/// their difference over the roof's pulses.
Eigen::Vector2d coarse_shift(const std::vector<Pierced>& pulses, const RoofTarget& target, double search, double& score);

}  // namespace swath::calib
