// SPDX-License-Identifier: GPL-3.0-or-later
// The design of a flight as it was flown: where each line went, how high and how fast.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "calib/adjust/adjustment.h"
#include "calib/terms.h"
#include "core/shot.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// A flight line as its returns and the trajectory show it.
struct FlownLine {
  int id = 0;
  double first = 0.0, last = 0.0;  ///< GPS time of its returns, s
  std::uint64_t returns = 0;       ///< read, inside the trajectory or not
  double heading = 0.0;            ///< course over ground from its first to its last return, from true north, rad, [0, 2 pi)
  double speed = 0.0;              ///< mean over ground, m/s
  double length = 0.0;             ///< from its first to its last return, m
  double width = 0.0;              ///< of the swath, twice the farthest return from the nadir, m
  double repeated = 0.0;           ///< share of returns whose recorded range is that of the return before
  double at_limit = 0.0;           ///< share of returns whose recorded range is the line's longest
  double height = 0.0;             ///< mean height of the scanner's IMU above the returns, m; NaN without returns inside the trajectory
};

class FlownLines {
 public:
  /// All must outlive it.
  FlownLines(const ShotGeometry& geometry, const trajectory::Trajectory& trajectory) : geometry_(geometry), trajectory_(trajectory) {}
  void add(int line, const core::Shots& shots);
  /// By id. Course, speed and length are NaN where the trajectory does not cover the line's ends.
  std::vector<FlownLine> lines() const;

 private:
  struct Sums {
    double first = 0, last = 0, height = 0, aside = 0, range = -1, longest = -1;
    std::uint64_t returns = 0, samples = 0, repeated = 0, at_limit = 0;
  };
  const ShotGeometry& geometry_;
  const trajectory::Trajectory& trajectory_;
  std::map<int, Sums> sums_;
};

/// Side of a square that holds `returns` returns of one line, m; the median of the lines that scan. 0 without any.
double side_for(const std::vector<FlownLine>& lines, double returns);

/// What looks wrong with the records of the lines, in words: ranges that are constant or end at a limit, lines whose times lie in one
/// another (mixed numbers), lines outside the trajectory.
std::vector<Finding> check_lines(const std::vector<FlownLine>& lines);

}  // namespace swath::calib
