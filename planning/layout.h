// SPDX-License-Identifier: GPL-3.0-or-later
// Flight lines over an area: as few as keep the overlap that is asked for, over ground of any shape. Map coordinates: east, north, m.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/height_field.h"

namespace swath::planning {

using Ring = std::vector<Eigen::Vector2d>;

/// Is the place inside an odd number of the rings?
bool inside(const std::vector<Ring>& rings, const Eigen::Vector2d& place);

/// A line to be flown straight and level.
struct FlightLine {
  std::string name;
  Eigen::Vector2d from, to;
  double level = 0.0;  ///< height in the ground's height system, m
  bool cross = false;
  bool scans = true;  ///< false: the mirror stands still at nadir

  double length() const { return (to - from).norm(); }
  Eigen::Vector2d along() const { return (to - from).normalized(); }
  /// To starboard.
  Eigen::Vector2d across() const { return {along().y(), -along().x()}; }
  /// Clockwise from grid north, rad.
  double course() const;
};

struct LayoutTask {
  std::vector<Ring> area;
  double half_angle = 0.0;    ///< rad
  double height = 0.0;        ///< m above the ground's level; see `above_lowest`
  bool above_lowest = false;  ///< the ground's level is its lowest place, not its mean
  bool terrain_following = false;
  double level_step = 1.0;  ///< m
  double overlap = 0.0;
  std::optional<double> spacing;    ///< m, in place of the overlap
  std::optional<double> direction;  ///< rad clockwise from grid north; none: the one in which the area is narrowest across
  int cross_lines = 0;
  double margin = 0.0;  ///< m around the area
};

struct Layout {
  std::vector<FlightLine> lines;
  double direction = 0.0;  ///< rad clockwise from grid north
  /// Least overlap of neighbouring lines, share of the swath, and where; below 0 a gap. Nothing with one line.
  std::optional<double> least_overlap;
  Eigen::Vector2d least_overlap_at = Eigen::Vector2d::Zero();
};

/// The area's middle, and its reach along a direction (none: the one in which it is narrowest across) and across it, m.
struct Extent {
  Eigen::Vector2d middle;
  double direction = 0.0, length = 0.0, width = 0.0;
};
Extent extent_of(const std::vector<Ring>& area, const std::optional<double>& direction);

/// Throws core::Error (usage) where the swath is empty because the ground is as high as the flight, or where more than 2000 lines are
/// needed.
Layout lay_out(const LayoutTask& task, const core::HeightField& ground);

}  // namespace swath::planning
