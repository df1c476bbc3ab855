// SPDX-License-Identifier: GPL-3.0-or-later
// Statistical outliers: points whose neighbours are farther than is usual around them; and small groups alone in space, birds and clouds.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"
#include "filters/noise/neighbours.h"

namespace swath::filters {

struct OutlierOptions {
  int mean_k = 4;
  double multiplier = 5.0;
  core::Metres window{30.0};
  core::Metres min_distance{5.0};
  core::Metres reach{10.0};
  core::Metres gap{10.0};
  int group = 20;
};

template <class V>
void describe(OutlierOptions& o, V& v) {
  v.option("mean_k", o.mean_k, core::within(1, most_neighbours), "Number of nearest neighbours whose mean distance judges a point.",
           "Rusu2008 3.2");
  v.option("multiplier", o.multiplier, core::at_least(0.0),
           "Mean distances beyond the mean of those around plus this many standard deviations are outliers.", "Rusu2008 3.2");
  v.option("window", o.window, core::above(0.0), "Side of the square whose points give that mean and standard deviation.");
  v.option("min_distance", o.min_distance, core::at_least(0.0),
           "A mean distance up to this is no outlier: keeps wires, masts and thin foliage over dense ground.");
  v.option("reach", o.reach, core::above(0.0), "Neighbours are sought within this distance; a point that has none is an outlier.");
  v.option("gap", o.gap, core::above(0.0), "Empty space around a group of points that hangs alone in the air or lies alone in the depth.");
  v.option("group", o.group, core::within(0, 1000), "Most points of such a group; 0 keeps all.");
  v.check(o.min_distance < o.reach, "min_distance must be less than reach");
}

/// What one call did, counted over the own points; a point may count as statistical and of a group.
struct OutlierCounts {
  core::Flagged statistical, grouped;
  core::Changed low_noise, high_noise;
  core::Kept untouched;  ///< neither judged nor anybody's neighbour
};

template <class V>
void describe(const OutlierCounts& r, V& v) {
  using core::if_any;
  v.result("low noise", r.low_noise, "Returns of class 7.");
  v.result("high noise", r.high_noise, "Returns of class 18.");
  v.result("statistical outliers", r.statistical, if_any(), "Returns whose neighbours are farther than is usual around them.");
  v.result("in groups alone in space", r.grouped, if_any(), "Returns in small groups with empty space around them.");
  v.result("withheld or noise already, not looked at", r.untouched, if_any(), "Returns that keep their class.");
}

/// The columns that it works with.
inline core::TileColumns columns(const OutlierOptions&) {
  using core::Column;
  return {.needs = {Column::flags, Column::classification}, .reads = {}, .gives = {Column::flags, Column::classification}};
}

/// Metres of points around a tile that its result depends on.
double halo(const OutlierOptions& o);

/// Side of the cells that the mean and standard deviation of a window are summed by, m.
double outlier_cell(const OutlierOptions& o);

/// Sets flag isolated and class 18, or flag low_point and class 7, among the first `own` points; those after are the halo and stay as they
/// are. A statistical outlier is low where more of the points of the columns around (3 x 3 lattice cells of side `reach`) lie above it than
/// below. The result of a point depends on the points within halo() of it and on nothing else.
OutlierCounts flag_outliers(core::Block& block, size_t own, const OutlierOptions& o);

}  // namespace swath::filters
