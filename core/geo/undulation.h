// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/geo/map_scale.h"

namespace swath::core {

/// Height of the geoid (EGM96, 1 m or better) above the WGS 84 ellipsoid, m; NaN where PROJ has no grid of it.
double undulation(const Place& place);

}  // namespace swath::core
