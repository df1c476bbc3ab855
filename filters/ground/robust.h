// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by hierarchic robust interpolation: Kraus & Pfeifer 1998, ISPRS J. 53, 193-203; Pfeifer, Stadler & Briese 2001, OEEPE
// workshop.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "filters/ground/ground_labels.h"

namespace swath::filters {

struct RobustOptions {
  core::Metres cell{1.0};
  int levels = 4;
  core::Metres sigma{0.1};
  double roughness = 0.05;
  core::Metres tolerance{0.5};
};

template <class V>
void describe(RobustOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of the cells that hold one point each at the finest level.", "Pfeifer2001, thinning");
  v.option("levels", o.levels, core::within(1, 6),
           "Number of levels, each with cells three times as wide; the widest wider than a building.", "Pfeifer2001, data pyramid");
  v.option("sigma", o.sigma, core::above(0.0), "Standard deviation of the heights of ground points.", "Kraus1998 eq 3");
  v.option("roughness", o.roughness, core::at_least(0.0),
           "Additional standard deviation of ground points per metre between the points of a level.");
  v.option("tolerance", o.tolerance, core::above(0.0), "Largest distance of a ground point from the finest surface.",
           "Pfeifer2001, classification");
}

/// The columns that it works with.
inline core::TileColumns columns(const RobustOptions&) { return ground_columns; }

/// Metres of points around a tile that its result depends on.
double halo(const RobustOptions& o);

/// Sets class ground or unassigned on the usable points among the first `own`; those after are the halo and keep their class.
/// Only last and only returns can be ground.
GroundCounts classify_ground_robust(core::Block& block, size_t own, const RobustOptions& o);

}  // namespace swath::filters
