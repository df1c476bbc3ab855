// SPDX-License-Identifier: GPL-3.0-or-later
// Water by what the laser does there: away from the nadir few pulses come back, and those that do lie in one level surface.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"

namespace swath::filters {

struct WaterOptions {
  double sparse = 0.12;
  int returns = 6;
  double slope = 0.003;
  core::Metres level{0.15};
  core::Metres reach{60.0};
};

template <class V>
void describe(WaterOptions& o, V& v) {
  v.option("sparse", o.sparse, core::within(0.01, 0.2),
           "A return is sparse where its flight line has at most this share of its usual density.");
  v.option("returns", o.returns, core::within(3, 1000), "Least number of sparse returns at one level that make a water.");
  v.option("slope", o.slope, core::within(0.0, 0.02),
           "Largest slope (rise / run) of a water surface; drained pavement falls by 0.005 or more.");
  v.option("level", o.level, core::above(0.0), "Largest distance of a return from its water's level: waves, differences between lines.");
  v.option("reach", o.reach, core::within(20.0, 500.0), "Level returns within this distance of sparse ones belong to the same water.");
}

struct WaterCounts {
  core::Changed water;
  std::uint64_t ground = 0;
};

template <class V>
void describe(const WaterCounts& r, V& v) {
  v.result("water", r.water, core::if_any(), "Returns classified as water.");
  v.result("of these ground before", r.ground, core::if_any(), "Of those: returns that were of class ground.");
}

/// The columns that it works with.
inline core::TileColumns columns(const WaterOptions&) {
  using core::Column;
  return {.needs = {Column::flags, Column::classification},
          .reads = {Column::strip, Column::return_number, Column::return_count},
          .gives = {Column::classification}};
}

/// Metres of points around a tile that its result depends on.
double halo(const WaterOptions& o);

/// Sets class water on last returns among the first `own` that were ground, unassigned or never classified, in metres above any datum;
/// those after are the halo and stay as they are. Finds water with sparse returns only, so none that a single line sees at full density
/// all over, and none without returns. Reads columns strip, return number and count where they are there; without strips all returns
/// count as one line's. The result depends on the points within halo() and not on their order.
WaterCounts classify_water(core::Block& block, size_t own, const WaterOptions& o);

}  // namespace swath::filters
