// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by progressive TIN densification: Axelsson 2000, IAPRS 33 (B4/1), 110-117.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "filters/ground/ground_labels.h"

namespace swath::filters {

struct PtdOptions {
  core::Metres building{40.0};
  core::Metres distance{1.4};
  core::Radians angle = core::degrees(15.0);
  core::Metres scatter{0.1};
  bool mirror = true;
};

template <class V>
void describe(PtdOptions& o, V& v) {
  v.option("building", o.building, core::above(0.0),
           "Width of the widest building: each square of this side gives its lowest point to the first TIN.", "Axelsson2000, seed points");
  v.option("distance", o.distance, core::above(0.0), "Largest distance of a new ground point from the facet below or above it.",
           "Axelsson2000, distance to facet");
  v.option("angle", o.angle, core::above_to(0.0, core::degrees(90.0).value),
           "Largest angle between a facet and the lines from its vertices to a new ground point.", "Axelsson2000, angles to nodes");
  v.option("scatter", o.scatter, core::at_least(0.0),
           "Scatter of the heights, subtracted from the distance before the angles are computed.");
  v.option("mirror", o.mirror, "Test a point too high over a steep facet again, mirrored in the facet's highest vertex.",
           "Axelsson2000, discontinuities");
}

/// The columns that it works with.
inline core::TileColumns columns(const PtdOptions&) { return ground_columns; }

/// Metres of points around a tile that its result depends on.
double halo(const PtdOptions& o);

/// Sets class ground or unassigned on the usable points among the first `own`; those after are the halo and keep their class.
/// Only last and only returns can be ground.
GroundCounts classify_ground_ptd(core::Block& block, size_t own, const PtdOptions& o);

}  // namespace swath::filters
