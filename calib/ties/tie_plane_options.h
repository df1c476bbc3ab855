// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the search for tie planes, and the sizes that follow from how a flight was flown.
#pragma once

#include <optional>

#include "core/config/option.h"
#include "core/records/sensor.h"

namespace swath::calib {

struct TiePlaneOptions {
  std::optional<core::Metres> cell, piece, extent, roughness, margin;  ///< without them by sized()
  core::Metres mismatch{0.05}, target_search{5.0};
  std::optional<int> planes;  ///< without it by sized()
  int returns = 100, fewest = 12;
  std::optional<double> per_second;
  bool thin_walls = false;
};

template <class V>
void describe(TiePlaneOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of the cubes that are judged plane or not; without it by the density of a line.");
  v.option("piece", o.piece, core::above(0.0),
           "Largest side of a plane, larger ones are cut; without it by the height, 12 m from 130 m on.");
  v.option("extent", o.extent, core::above(0.0), "Minimum of a plane's half extents; without it an eighth of `piece`.");
  v.option("roughness", o.roughness, core::above(0.0),
           "Largest rms of one line's returns about their plane; without it by `piece` and the noise.");
  v.option("margin", o.margin, core::at_least(0.0),
           "Returns nearer than this to an edge are left out; without it by the height, 0.4 m from 400 m on.");
  v.option("mismatch", o.mismatch, core::at_least(0.0), "Rms by which lines miss one another at present.");
  v.option("target_search", o.target_search, core::above(0.0), "Distance from its survey within which a target's plane is looked for.");
  v.option("planes", o.planes, core::within(1, 100000),
           "Most planes, surveyed targets not counted; without it two per second of lines, 1200 at least.");
  v.option("per_second", o.per_second, core::above(0.0),
           "Most planes of one line in one second, those that say most of its pose; without it `planes` alone.");
  v.option("thin_walls", o.thin_walls, "Find walls that leave only a few returns in a cell, too; takes more memory.");
  v.option("returns", o.returns, core::within(10, 10000), "Most returns of one line on one plane.");
  v.option("fewest", o.fewest, core::within(4, 10000), "Fewest returns of one line on one plane.");
  v.check(o.returns >= o.fewest, "returns must be fewest or more");
  v.check(!o.piece || !o.extent || o.piece->value > 2.0 * o.extent->value, "piece must be wider than twice extent");
}

/// How a flight was flown, as its sizes need it; 0: not known.
struct FlownScale {
  double height = 0.0;   ///< of the scanner above the ground, m
  double density = 0.0;  ///< returns of one line per m^2
  double noise = 0.0;    ///< of a return across its beam and along, m
  double seconds = 0.0;  ///< of all lines together
};
/// Of lines whose time is not known. `sensor`: sigmas of single records.
FlownScale scale_of(double height, double density, const core::SensorSigma& sensor);

/// The options with every size: those that are stated, the others by the flight. Where nothing is known of it they are those of a flight at
/// 400 m or more: pieces of 12 m, 0.08 m of roughness, 0.4 m from the edges, cells by what find_tie_planes() sees.
TiePlaneOptions sized(TiePlaneOptions options, const FlownScale& scale);

}  // namespace swath::calib
