// SPDX-License-Identifier: GPL-3.0-or-later
// Slope and hillshade of a model of heights.
#pragma once

#include "core/config/option.h"
#include "core/config/units.h"
#include "core/grid.h"

namespace swath::core {

struct Light {
  Radians azimuth = degrees(315.0);
  Radians altitude = degrees(45.0);
  bool multidirectional = false;
  double exaggeration = 1.0;
};

template <class V>
void describe(Light& o, V& v) {
  v.option("azimuth", o.azimuth, within(0.0, 2.0 * pi), "Direction that the light comes from, from grid north, clockwise.", "Horn1981");
  v.option("altitude", o.altitude, above_to(0.0, pi / 2.0), "Height of the light above the horizon.", "Horn1981");
  v.option("multidirectional", o.multidirectional,
           "Four lights from 225 to 360 deg, weighted by aspect, in place of one: no slope is dark.", "Mark1992");
  v.option("exaggeration", o.exaggeration, above(0.0), "Factor on heights before shading; slopes do not use it.");
}

/// Rise per metre eastward and northward at the cells of `own` from `model`, which holds a border of one cell around them (the 3 x 3
/// operator of Horn 1981). A neighbour without a height is continued from the one opposite, or is level with the cell.
struct Gradients {
  std::vector<float> east, north;  ///< NaN where the cell has no height
};
Gradients gradients(const Grid& model, const Lattice& own);

/// height: slope, degrees from level. reason: that of the model.
Grid slope(const Grid& model, const Lattice& own);

/// height: 0 (in shade) to 255 (facing the light), Lambert's cosine law; level ground has 255 sin(altitude). reason: that of the model.
Grid hillshade(const Grid& model, const Lattice& own, const Light& light = {});

}  // namespace swath::core
