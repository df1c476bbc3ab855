// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/geo/map_scale.h"

namespace swath::core {

/// Height of the geoid (EGM96, 1 m or better) above the WGS 84 ellipsoid, m; NaN where PROJ has no grid of it.
double undulation(const Place& place);

/// A common height error this close to the undulation, m, is taken for heights above the geoid in place of the ellipsoid, or the reverse:
/// national geoids and level datums differ from EGM96 by up to about 2 m, and its grid and what else is common to a flight add to that.
constexpr double like_geoid = 2.5;

}  // namespace swath::core
