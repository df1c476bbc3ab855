// SPDX-License-Identifier: GPL-3.0-or-later
// Supports of wires: poles, towers. Known by their own returns, and by the wires that meet there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "terrain/corridor/strands.h"

namespace swath::terrain {

/// A return of class 15. Map frame minus an origin, m.
struct TowerPoint {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// Returns of class 15 that belong together.
struct TowerGroup {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< middle in plan: the middle of each level's outermost returns, mean of the levels
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of `at`, m2: the levels' middles scatter
  double top = 0.0, bottom = 0.0;                        ///< highest and lowest return
  size_t returns = 0;
};

/// Groups of at least three returns with gaps of at most 4 m in plan. Does not depend on the order of the points.
std::vector<TowerGroup> tower_groups(const std::vector<TowerPoint>& points);

/// Where two strands meet: on strand a at station s.
struct Meeting {
  double s = 0.0, sigma = 0.0;  ///< m
  double miss = 0.0;            ///< m: how far they pass each other there
  bool in_plan = false;         ///< by their directions in plan; false: by their heights
  bool found = false;
};

/// The meeting of the ends of two strands that are one wire hung over a support: where their heights cross, or, where the wire turns there,
/// their lines in plan; whichever is known better. Not found: the meeting is farther than `reach` from one of the ends, they miss each
/// other by more than 1.5 m, or its station is not known to 1 m.
Meeting meeting_of(const Strand& a, bool a_ends_last, const Strand& b, bool b_ends_last, double reach, double sigma_line);

/// What the mean of two wires' flight lines differs by, as a share of the variance of one line: 0 where both have the same lines in the
/// same shares.
double unlike_lines(const CatenaryFit& a, const CatenaryFit& b);

}  // namespace swath::terrain
