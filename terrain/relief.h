// SPDX-License-Identifier: GPL-3.0-or-later
// Slope and hillshade of a terrain model.
#pragma once

#include "core/grid.h"
#include "core/option.h"

namespace swath::terrain {

struct ReliefOptions {
  core::Radians azimuth = core::degrees(315.0);
  core::Radians altitude = core::degrees(45.0);
  double exaggeration = 1.0;
};

template <class V>
void describe(ReliefOptions& o, V& v) {
  v.option("azimuth", o.azimuth, core::within(0.0, 6.283185307179586), "Direction that the light comes from, from grid north, clockwise.");
  v.option("altitude", o.altitude, core::above_to(0.0, 1.5707963267948966), "Height of the light above the horizon.");
  v.option("exaggeration", o.exaggeration, core::above(0.0), "Factor on heights before shading; slopes are without it.");
}

/// Rise per metre eastward and northward at the cells of `own` from `model`, which holds a border of one cell around them (the 3 x 3
/// operator of Horn 1981). A neighbour without a height is continued from the one opposite, or is level with the cell.
struct Gradients {
  std::vector<float> east, north;  ///< NaN where the cell has no height
};
Gradients gradients(const core::Grid& model, const core::Lattice& own);

/// height: slope, degrees from level. reason: that of the model.
core::Grid slope(const core::Grid& model, const core::Lattice& own);

/// height: 0 (in shade) to 255 (facing the light), Lambert's cosine law. reason: that of the model.
core::Grid hillshade(const core::Grid& model, const core::Lattice& own, const ReliefOptions& options);

}  // namespace swath::terrain
