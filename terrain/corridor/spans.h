// SPDX-License-Identifier: GPL-3.0-or-later
// Spans of a power line: conductors between two supports, with sag.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "terrain/corridor/strands.h"
#include "terrain/corridor/supports.h"

namespace swath::terrain {

/// One end of a conductor. Not known: the wire leaves the data, or its support was not found.
struct ConductorEnd {
  double s = 0.0, sigma = 0.0;  ///< of the support's axis on the conductor's line; not known: the outermost return
  bool known = false;
  std::optional<size_t> partner;  ///< the conductor on the other side, where their meeting gave s
  std::optional<size_t> pylon;
};

struct Sag {
  double value = 0.0, sigma = 0.0;  ///< m, largest height of the chord between the ends above the wire
  double s = 0.0;                   ///< where
};

struct Conductor {
  Strand strand;
  size_t span = 0;
  ConductorEnd first, last;  ///< at the smaller and the larger s
  std::optional<Sag> sag;    ///< where both ends are known
  int wires = 1;             ///< of a bundle
  double spacing = 0.0;      ///< m, between neighbouring wires of a bundle
  double chord(double s) const {
    const double z1 = strand.fit.curve.z(first.s), z2 = strand.fit.curve.z(last.s);
    return z1 + (z2 - z1) * (s - first.s) / (last.s - first.s);
  }
};

struct Pylon {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of `at`, m2
  double top = 0.0;                                      ///< highest return of class 15, or the highest wire there
  size_t returns = 0;                                    ///< of class 15; 0: known by its wires alone
  std::vector<size_t> spans;
};

struct Span {
  std::vector<size_t> conductors;  ///< from left to right, looking along the axis, then from the lowest up
  PlanLine axis;                   ///< through the middle of the conductors
  double first = 0.0, last = 0.0;  ///< of the axis
  std::optional<size_t> pylon_first, pylon_last;
  bool is_whole() const { return pylon_first && pylon_last; }
  double length() const { return last - first; }
};

struct PowerLines {
  std::vector<Span> spans;  ///< by the first end's place
  std::vector<Conductor> conductors;
  std::vector<Pylon> pylons;
};

struct SpanOptions {
  StrandOptions strands;
  double beside = 20.0;      ///< m: conductors of one span are no farther from the next
  double end_reach = 25.0;   ///< m from a wire's last return to its support
  double least_span = 25.0;  ///< m of returns of the longest conductor
};

/// The result does not depend on the order of the points. Map frame minus an origin, m.
PowerLines find_power_lines(const std::vector<WirePoint>& wires, const std::vector<TowerPoint>& towers, const SpanOptions& o = {});

}  // namespace swath::terrain
