// SPDX-License-Identifier: GPL-3.0-or-later
// ASPRS classes of what is not ground: vegetation by height, buildings, bridge decks, wires and their supports.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"

namespace swath::filters {

struct ClassifyOptions {
  core::Metres medium_vegetation{0.5};
  core::Metres high_vegetation{2.0};
  core::Metres building_height{2.0};
  core::Metres building_side{3.0};
  core::Metres roughness{0.15};
  core::Metres bridge_length{60.0};
  bool decks_in_ground = true;
  core::Metres wire_height{5.0};
};

template <class V>
void describe(ClassifyOptions& o, V& v) {
  v.option("medium_vegetation", o.medium_vegetation, core::at_least(0.0),
           "Height above ground at which low vegetation (3) ends and medium (4) begins.",
           "LAS 1.4 R15 names the classes, not their heights");
  v.option("high_vegetation", o.high_vegetation, core::at_least(0.0),
           "Height above ground at which medium vegetation (4) ends and high (5) begins.",
           "LAS 1.4 R15 names the classes, not their heights");
  v.option("building_height", o.building_height, core::at_least(1.0), "Least height of a roof (6) above ground.");
  v.option("building_side", o.building_side, core::within(1.0, 30.0),
           "Minimum area of connected returns of a roof, as the side of a square.");
  v.option("roughness", o.roughness, core::above(0.0), "Largest distance of a roof's or deck's return from its plane.");
  v.option("bridge_length", o.bridge_length, core::within(0.0, 500.0),
           "Longest bridge deck (17) looked for; its points are needed around each tile. 0: none.");
  v.option("decks_in_ground", o.decks_in_ground, "Look for decks among ground points, too. A dam between sheer walls looks like a deck.");
  v.option("wire_height", o.wire_height, core::at_least(1.0), "Least height of a wire (14) above ground.");
  v.check(o.high_vegetation >= o.medium_vegetation, "high_vegetation must not be less than medium_vegetation");
}

/// Classes set among the own points.
struct ClassifyCounts {
  core::Changed low_vegetation, medium_vegetation, high_vegetation, building, wire, tower, bridge_deck, unassigned, low_noise;
  core::Kept kept;
};

template <class V>
void describe(const ClassifyCounts& r, V& v) {
  using core::if_any;
  v.result("low vegetation", r.low_vegetation, if_any(), "Returns of class 3.");
  v.result("medium vegetation", r.medium_vegetation, if_any(), "Returns of class 4.");
  v.result("high vegetation", r.high_vegetation, if_any(), "Returns of class 5.");
  v.result("building", r.building, if_any(), "Returns of class 6.");
  v.result("wire", r.wire, if_any(), "Returns of class 14.");
  v.result("tower", r.tower, if_any(), "Returns of class 15.");
  v.result("bridge deck", r.bridge_deck, if_any(), "Returns of class 17.");
  v.result("low noise", r.low_noise, if_any(), "Returns of class 7: below ground returns among which they are scattered.");
  v.result("unassigned", r.unassigned, if_any(), "Returns of class 1.");
  v.result("ground, water or noise, not looked at", r.kept, if_any(), "Returns that keep their class, withheld ones too.");
}

/// The columns that it works with.
inline core::TileColumns columns(const ClassifyOptions&) {
  using core::Column;
  return {.needs = {Column::flags, Column::classification, Column::height},
          .reads = {Column::return_number, Column::return_count},
          .gives = {Column::flags, Column::classification}};
}

/// Metres of points around a tile that its result depends on.
double halo(const ClassifyOptions& o);

/// Classes those of the first `own` points that are neither ground, water, noise nor withheld; those after are the halo and stay as they
/// are. Needs columns classification (with ground) and height. Unassigned stay points at or below the ground's height or without one, and
/// smooth planes that are neither building nor deck: vehicles, containers, ground that the ground filter left out. Points flagged isolated
/// and of class 18 that lie on a wire become wire, those of its supports tower. Low noise, flag low_point, become returns a metre or more
/// below the terrain model where a quarter of the last returns within one and a half times the usual distance lie a metre above them, as
/// ground or at the model; and those 0.3 m or more below it where 60 % of three or more are ground 0.3 m above them. The result depends on
/// the points within halo() and not on their order.
ClassifyCounts classify(core::Block& block, size_t own, const ClassifyOptions& o);

}  // namespace swath::filters
