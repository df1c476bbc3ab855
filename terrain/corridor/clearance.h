// SPDX-License-Identifier: GPL-3.0-or-later
// Distances of conductors to ground, vegetation, buildings and other wires, at rest and swung by the wind.
#pragma once

#include <optional>
#include <vector>

#include "terrain/corridor/obstacles.h"
#include "terrain/corridor/spans.h"

namespace swath::terrain {

struct ClearanceOptions {
  double reach = 30.0;                  ///< m: what is farther from a conductor is not looked at
  double swing = 0.5236;                ///< rad: the wind swings the conductor by up to this angle to both sides
  std::array<double, hazards> limit{};  ///< m, of each Hazard
};

/// The smallest distance of a conductor to one kind of obstacle.
struct Clearance {
  Hazard kind = Hazard::ground;
  double at_rest = 0.0, sigma = 0.0;  ///< m; to the ground straight down, else in space. Of a single return, its own error included.
  double swung = 0.0;                 ///< m: the smallest of all positions from -swing to swing
  Eigen::Vector3d wire = Eigen::Vector3d::Zero(), other = Eigen::Vector3d::Zero();  ///< at rest: the two places
  double s = 0.0;                                                                   ///< on the conductor's line
  std::optional<size_t> conductor{};                                                ///< the other one
  double limit = 0.0;
  bool is_kept() const { return swung >= limit; }
};

constexpr double infringement_cell = 1.0;  ///< m: of the squares of which infringements are the worst

/// A return that is nearer than its limit.
struct Infringement {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Hazard kind = Hazard::ground;
  double distance = 0.0;  ///< m, swung
};

struct ConductorClearances {
  std::vector<Clearance> smallest;          ///< of the kinds that are within reach
  std::vector<Infringement> infringements;  ///< of vegetation and buildings: the worst of each square metre
};

/// A swung conductor turns about the chord of its ends, each place by the same angle. Sigmas: of the wire against what the same flight
/// lines see. The other wires are at rest. `obstacles`: those within reach of the conductor.
ConductorClearances clearances_of(const PowerLines& lines, size_t conductor, const Obstacles& obstacles, const ClearanceOptions& o);

/// A tree that would touch a conductor if it fell towards it.
struct FallingTree {
  Eigen::Vector3d top = Eigen::Vector3d::Zero();
  double height = 0.0;  ///< m above the ground
  double margin = 0.0;  ///< m from its top, fallen, to the conductor at rest; below 0: it is longer than the way
  size_t conductor = 0;
};

/// The highest returns of vegetation within 2 m of which none is higher, 3 m or more above the ground, whose margin to a conductor of the
/// span is below `o.limit` of vegetation. Each with the conductor that it comes nearest to.
std::vector<FallingTree> falling_trees(const PowerLines& lines, size_t span, const Obstacles& obstacles, const ClearanceOptions& o);

}  // namespace swath::terrain
