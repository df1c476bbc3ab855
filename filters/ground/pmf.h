// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by the progressive morphological filter: Zhang, Chen, Whitman, Shyu, Yan & Zhang 2003, IEEE TGRS 41(4), 872-882.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "filters/ground/ground_labels.h"

namespace swath::filters {

struct PmfOptions {
  core::Metres cell_size{1.0};
  core::Metres max_window_size{33.0};
  double slope = 1.0;
  core::Metres initial_distance{0.15};
  core::Metres max_distance{2.5};
  bool exponential = true;
};

template <class V>
void describe(PmfOptions& o, V& v) {
  v.option("cell_size", o.cell_size, core::above(0.0), "Unit of the windows: the first is three of them wide.", "Zhang2003, c");
  v.option("max_window_size", o.max_window_size, core::above(0.0),
           "Windows grow until one is at least this wide: the width of the widest building.", "Zhang2003 eq 4 and 5");
  v.option("slope", o.slope, core::at_least(0.0), "Steepest ground kept (rise / run).", "Zhang2003 eq 7, s");
  v.option("initial_distance", o.initial_distance, core::at_least(0.0), "Height over the first opening up to which a point is kept.",
           "Zhang2003 eq 7, dh_0");
  v.option("max_distance", o.max_distance, core::at_least(0.0), "The same for every opening at most.", "Zhang2003 eq 7, dh_max");
  v.option("exponential", o.exponential, "Windows double from step to step; otherwise they grow by four cells.", "Zhang2003 eq 4 and 5");
  v.check(o.max_window_size >= o.cell_size, "max_window_size must span at least one cell");
}

/// The columns that it works with.
inline core::TileColumns columns(const PmfOptions&) { return ground_columns; }

/// Metres of points around a tile that its result depends on.
double halo(const PmfOptions& o);

/// Sets class ground or unassigned on the usable points among the first `own`; those after are the halo and keep their class.
/// Only last and only returns can be ground.
GroundCounts classify_ground_pmf(core::Block& block, size_t own, const PmfOptions& o);

}  // namespace swath::filters
