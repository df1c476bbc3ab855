// SPDX-License-Identifier: GPL-3.0-or-later
// Noise: points outside the range gate, isolated points, points far below the ground. Flags and classes are set, nothing is deleted.
#pragma once

#include <optional>

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"

namespace swath::filters {

struct NoiseOptions {
  core::Metres radius{5.0};
  int neighbours = 4;
  bool widen = true;
  core::Metres low_depth{1.0};
  core::Metres low_radius{5.0};
  int low_group = 6;
  std::optional<core::Metres> range_min;
  std::optional<core::Metres> range_max;
};

template <class V>
void describe(NoiseOptions& o, V& v) {
  v.option("radius", o.radius, core::above(0.0), "Radius of the ball in which an isolated point's neighbours are counted.");
  v.option("neighbours", o.neighbours, core::within(0, 1000), "A point with fewer neighbours is isolated; 0 keeps all.");
  v.option("widen", o.widen, "Where points are sparse, neighbours within twice the radius count, too.");
  v.option("low_depth", o.low_depth, core::above(0.0), "A low point lies at least this far below the ground around it.");
  v.option("low_radius", o.low_radius, core::above(0.0), "Horizontal radius in which a group of low points must stand alone.");
  v.option("low_group", o.low_group, core::within(0, 1000), "Most points of one group of low points; 0 keeps all.");
  v.option("range_min", o.range_min, core::at_least(0.0), "Shortest range that is believed; without it there is no limit.");
  v.option("range_max", o.range_max, core::above(0.0), "Longest range that is believed; without it there is no limit.");
  v.check(!o.range_min || !o.range_max || *o.range_min < *o.range_max, "range_min must be less than range_max");
}

/// What one call did, counted over the own points; a point may count under several.
struct NoiseCounts {
  core::Flagged range_gate, isolated, low_point;
  core::Changed low_noise, high_noise;
  core::Kept untouched;  ///< neither judged nor anybody's neighbour
};

template <class V>
void describe(const NoiseCounts& r, V& v) {
  using core::if_any;
  v.result("low noise", r.low_noise, "Returns of class 7.");
  v.result("high noise", r.high_noise, "Returns of class 18.");
  v.result("isolated", r.isolated, if_any(), "Returns with too few neighbours.");
  v.result("low points", r.low_point, if_any(), "Returns below the ground around them.");
  v.result("outside the range gate", r.range_gate, if_any(), "Returns whose range is below range_min or above range_max.");
  v.result("withheld or noise already, not looked at", r.untouched, if_any(), "Returns that keep their class.");
}

/// The columns that it works with.
inline core::TileColumns columns(const NoiseOptions& o) {
  using core::Column;
  return {.needs = {Column::flags, Column::classification},
          .reads = o.range_min || o.range_max ? core::ColumnSet{Column::range} : core::ColumnSet{},
          .gives = {Column::flags, Column::classification}};
}

/// Metres of points around a tile that its result depends on.
double halo(const NoiseOptions& o);

/// Sets flags range_gate, isolated, low_point and classes 7 (low point, range too long) or 18 (isolated, range too short) among the first
/// `own` points; those after are the halo and stay as they are.
/// - Range gate: range outside [range_min, range_max]; such points are no neighbours to others. Needs column range (else core::Error).
/// - Isolated: fewer than `neighbours` other points within `radius` in 3D (exact); where fewer than eight times as many lie within it in
///   plan, so that sparse ground would be isolated too, also within twice the radius. Where the 9 x 9 columns around (side radius) hold so
///   few that less than twice `neighbours` are usual within twice the radius, only those with fewer than `neighbours` in these columns.
///   Without `widen` the ball of `radius` alone decides.
/// - Low point: at most `low_group` points (itself one) within `low_radius` horizontally are lower than low_depth above it, and the
///   lowest points of the cells around (side low_radius, second and third ring) say the same: of the 20 chords between opposite cells at
///   least 8 exist, and at most one passes less than low_depth above the point. Where fewer than twice low_group are usual within
///   low_radius nothing is judged: there a few ground returns between roofs and crowns look like such a group.
/// So groups of multipath lows are found, on slopes too (from a depth of about low_depth + slope * low_radius). Kept are valleys (chords
/// along them), pits, quarries and shafts with more than low_group points at the bottom, and sparse ground under trees (its company lies
/// around). A shaft with fewer points is taken for noise.
NoiseCounts flag_noise(core::Block& block, size_t own, const NoiseOptions& o);

}  // namespace swath::filters
