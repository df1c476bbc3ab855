// SPDX-License-Identifier: GPL-3.0-or-later
// Returns at surveyed roofs, with the direction that their beams came from.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/area.h"
#include "core/block.h"
#include "quality/beam_tracks.h"

namespace swath::quality {

/// A surveyed roof, or another plane that ends in the air on all or most sides; map metres.
struct RoofTarget {
  std::string name;
  std::vector<Eigen::Vector3d> corners;  ///< around it, in either direction
  double sigma = 0.0;                    ///< m, of each horizontal coordinate of a corner
};

/// The side of a target from corner k to the next; `out` points away from the roof.
struct RoofSide {
  Eigen::Vector2d from, along, out;  ///< m from the first corner; unit vectors
  double length = 0.0;
};
std::vector<RoofSide> sides_of(const RoofTarget& target);

/// Where a place lies: the nearest side, metres beyond it (negative: over the roof) and from its ends (negative: past them).
struct PlaceAtRoof {
  std::size_t side = 0;
  double out = 0.0, from_end = 0.0;
};
PlaceAtRoof place_at(const std::vector<RoofSide>& sides, const Eigen::Vector2d& at);

/// The plane through a target's corners by least squares; x, y in m from the first corner.
struct RoofPlane {
  double height = 0.0;                              ///< above the first corner's map height 0, at x = y = 0
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< rise / run
  explicit RoofPlane(const RoofTarget& target);
  double at(const Eigen::Vector2d& p) const { return height + slope.dot(p); }
};

/// A return at a target; plain data. Places in m from the target's first corner.
struct RoofReturn {
  std::int32_t target = 0, line = 0;
  double time = 0.0;
  float x = 0.0F, y = 0.0F;
  float above = 0.0F;                ///< m above the target's plane
  float run_x = 0.0F, run_y = 0.0F;  ///< m that the beam runs east and north for each metre that it comes down
  std::int32_t number = 0;           ///< of the return
};

constexpr double roof_band = 2.0;  ///< m on both sides of an edge that it is looked for by

/// On the map, m: returns of beams at the target lie in it.
core::Box reach_of(const RoofTarget& target);
/// Could returns of a beam at the target lie in the box?
bool is_near(const RoofTarget& target, const core::Box& box);

constexpr double beside_roof = 15.0;  ///< m beyond that band where returns of beams that pass it are looked for without a trajectory

/// Of the first `own` points those whose beams cross a target's plane within it or up to roof_band around it, or that lie there themselves.
/// `scanner`: its place at each point's time, m from the block's origin, points without one (NaN) are left out; empty: not known,
/// then those up to beside_roof around a target, their runs not a number. None without columns time and strip.
std::vector<RoofReturn> returns_at_roofs(const core::Block& block, std::size_t own, const std::vector<Eigen::Vector3d>& scanner,
                                         const std::vector<RoofTarget>& targets);

/// Gives the returns their runs by the pulses that came back twice within reach of each target, 2.5 s of a line after the other, and leaves
/// out those where these do not show where the scanner was, or whose times are not known. The sigma of the runs at each target; 0 where it
/// has no returns. Returns in any order give the same.
std::vector<double> find_runs(std::vector<RoofReturn>& returns, const std::vector<PulseSpan>& spans,
                              const std::vector<RoofTarget>& targets);

/// Where the beam of a return crosses the target's plane raised by `raise`, m from its first corner.
Eigen::Vector2d crossing_of(const RoofReturn& r, const RoofPlane& plane, double raise);

/// Of each pulse the first of these returns, by line and time; returns in any order give the same.
std::vector<RoofReturn> first_of_pulses(std::vector<RoofReturn> returns);

}  // namespace swath::quality
