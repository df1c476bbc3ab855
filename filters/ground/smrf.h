// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by the Simple Morphological Filter: Pingel, Clarke & McBride 2013, ISPRS J. 77, 21-30.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "filters/ground/ground_columns.h"

namespace swath::filters {

struct SmrfOptions {
  core::Metres cell{1.0};
  double slope = 0.15;
  core::Metres window{18.0};
  core::Metres threshold{0.5};
  double scalar = 1.25;
  core::Metres cut{0.0};
};

template <class V>
void describe(SmrfOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one raster cell.", "Pingel2013, stage 1");
  v.option("slope", o.slope, core::within(0.0, 5.0), "Steepest ground kept (rise / run).", "Pingel2013, stage 2");
  v.option("window", o.window, core::above(0.0), "Radius of the widest opening: half the width of the largest object taken off.",
           "Pingel2013, stage 2");
  v.option("threshold", o.threshold, core::at_least(0.0),
           "Largest distance of a ground point from the provisional surface, on level ground.", "Pingel2013, stage 4");
  v.option("scalar", o.scalar, core::at_least(0.0), "Further distance per unit of the surface's slope.", "Pingel2013, stage 4");
  v.option("cut", o.cut, core::at_least(0.0),
           "Spacing of the net that is cut through the surface to break up very large objects; 0 for none.", "Pingel2013, stage 2");
  v.check(o.window >= o.cell, "window must span at least one cell");
  v.check(o.cut.value == 0.0 || o.cut >= o.cell, "cut must be 0 or span at least one cell");
}

/// What one call did, counted over the own points.
struct SmrfCounts {
  core::Changed ground, object;
  core::Kept untouched;
  std::uint64_t no_surface = 0;
};

template <class V>
void describe(const SmrfCounts& r, V& v) {
  v.result("ground", r.ground, "Returns classified as ground.");
  v.result("not ground", r.object, "Returns classified as unassigned.");
  v.result("withheld or noise, not looked at", r.untouched, core::if_any(), "Returns that keep their class.");
  v.result("no ground within reach", r.no_surface, core::if_any(), "Of those not ground: without ground nearby to compare with.");
}

/// The columns that it works with.
inline core::TileColumns columns(const SmrfOptions&) { return ground_columns; }

/// Metres of points around a tile that its result depends on.
double halo(const SmrfOptions& o);

/// Sets class ground or unassigned on the usable points among the first `own`; those after are the halo and keep their class.
/// Only last returns make the surface and can be ground. The result of a point depends on the points within halo() of it and on nothing
/// else.
SmrfCounts classify_ground_smrf(core::Block& block, size_t own, const SmrfOptions& o);

}  // namespace swath::filters
