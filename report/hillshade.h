// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/grid.h"
#include "core/option.h"
#include "core/units.h"

namespace swath::report {

struct HillshadeOptions {
  core::Radians azimuth = core::degrees(315.0);  ///< of the light, from north clockwise (single light)
  core::Radians altitude = core::degrees(45.0);  ///< of the light above the horizon
  bool multidirectional = true;                  ///< four lights from 225 to 360 deg, weighted by aspect, in place of one
  double exaggeration = 1.0;                     ///< factor on heights (also height unit / horizontal unit where they differ)
};

template <class V>
void describe(HillshadeOptions& o, V& v) {
  v.option("azimuth", o.azimuth, "Where the light comes from, clockwise from north; without multidirectional.", "Horn1981");
  v.option("altitude", o.altitude, core::within(0.0, core::pi / 2), "Height of the light above the horizon.", "Horn1981");
  v.option("multidirectional", o.multidirectional, "Four lights weighted by aspect, so that no slope lies in darkness.", "Mark1992");
  v.option("exaggeration", o.exaggeration, core::above(0.0), "Factor on heights.");
}

/// Brightness of each cell, 0 (dark) to 1 (facing the light), in the order of the grid; NaN where there is no height. Level ground has
/// sin(altitude). Light strikes a plane through the 3 x 3 neighbours (Horn 1981); a neighbour without height counts as the cell itself.
/// `height`: row-major from the south-west on `lattice`. Sources: Horn, Proc. IEEE 69(1), 1981; Mark, USGS OFR 92-422, 1992.
std::vector<float> hillshade(const core::Lattice& lattice, const std::vector<float>& height, const HillshadeOptions& options = {});

}  // namespace swath::report
