// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by a surface that is fitted to the last returns, with a probability for every point.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"
#include "filters/ground/ground_coarse.h"
#include "filters/ground/ground_labels.h"
#include "filters/ground/ground_probability.h"

namespace swath::filters {

struct GroundOptions {
  core::Metres widest{50.0};
  core::Metres longest{180.0};
  core::Radians steepest = core::degrees(55.0);
  core::Metres noise{0.03};
  Grass grass = Grass::mown;
};

template <class V>
void describe(GroundOptions& o, V& v) {
  v.option("widest", o.widest, core::within(2.0, 200.0),
           "Width of the widest building or bridge, across its narrower side; wider ones are found by walls.");
  v.option("longest", o.longest, core::within(0.0, 1000.0),
           "Length of the longest building found by the walls around it, however wide; 0 m: by width alone.");
  v.option("steepest", o.steepest, core::within(10 * core::degree, 80 * core::degree),
           "Steepest ground: what rises more steeply and stands alone is an object.");
  v.option("noise", o.noise, core::within(0.005, 1.0),
           "Standard deviation of the heights of returns from hard level ground, strips' misfit included.");
  v.option("grass", o.grass, "Grass of 7 to 15 cm: mown counts as ground, as most makers of clouds have it; bare_earth does not.");
}

/// One entry for each of the first `own` points.
std::vector<GroundEvidence> ground_evidence(const core::Block& block, size_t own, const GroundOptions& o);

/// What one call did, counted over the own points.
struct GroundChances : GroundCounts {
  std::uint64_t doubtful = 0;         ///< probability between 0.25 and 0.75
  std::vector<RaisedSurface> raised;  ///< on and around the own points; wider ones than halo() are not known
};

template <class V>
void describe(const GroundChances& r, V& v) {
  v.result("ground", r.ground, "Returns classified as ground.");
  v.result("not ground", r.object, "Returns classified as unassigned.");
  v.result("doubtful: probability between 0.25 and 0.75", r.doubtful, "Returns that may be ground or not.");
  v.result("not a last return, not ground", r.early, core::if_any(), "Of those not ground: a later return of the pulse lies below.");
  v.result("withheld or noise, not looked at", r.untouched, core::if_any(), "Returns that keep their class.");
  v.result("no ground within reach", r.no_surface, core::if_any(), "Of those not ground: without ground nearby to compare with.");
}

/// The columns that it works with.
inline core::TileColumns columns(const GroundOptions&) {
  using core::Column;
  return {.needs = {Column::flags},
          .reads = {Column::return_number, Column::return_count, Column::strip},
          .gives = {Column::classification, Column::ground_probability}};
}

/// Metres of points around a tile that its result depends on.
double halo(const GroundOptions& o);
/// Metres within which it depends on all of them; farther off on the lowest that may be ground of each cell of 1 m alone.
double near_halo(const GroundOptions& o);

/// Metres around the outermost points that the rasters at work go on.
double rim(const GroundOptions& o);

/// A box of map coordinates, half open.
struct Bounds {
  double west, south, east, north;
};
/// Rows, ascending, of the points that the result of a tile depends on: all of those near it, and of the others the lowest of their cells.
std::vector<std::uint32_t> needed_around(const core::Block& b, const Bounds& tile, const GroundOptions& o);

/// Sets class ground or unassigned and the column ground_probability of the usable points among the first `own`; those after are the halo
/// and keep theirs. Ground is what has a probability of at least 0.5. Only the
/// last or only return of a pulse can be ground: the beam went on behind every earlier one, so that one lay above something lower; its
/// probability is 0. Points that are not usable get NaN. The result of a point depends on the points within halo() of it and on nothing
/// else.
GroundChances classify_ground(core::Block& block, size_t own, const GroundOptions& o);

}  // namespace swath::filters

template <>
struct swath::core::Choices<swath::filters::Grass> {
  static constexpr std::array<std::string_view, 2> names{"mown", "bare_earth"};
};
