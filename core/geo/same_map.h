// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/geo/crs.h"

namespace swath::core {

/// Have both the same easting and northing? Heights are left out of it, also those of the ellipsoid (EPSG:25832+ellipsoidal). Both must not
/// be empty.
bool is_same_map(const Crs& a, const Crs& b);

}  // namespace swath::core
