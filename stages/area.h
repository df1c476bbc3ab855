// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/stage.h"

namespace swath::stages {

/// What features of the map and the points of a run may lie beyond its own places, m.
constexpr double around_clouds = 30e3, around_trajectory = 40e3;

/// Sets context.area: `places` (map metres) grown by `margin`, each side replaced by what the survey states.
void set_area(Context& context, const Box& places, double margin);

}  // namespace swath::stages
