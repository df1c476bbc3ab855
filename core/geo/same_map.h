// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/geo/crs.h"

namespace swath::core {

/// Have both the same easting and northing? Heights are left out of it, also those of the ellipsoid (EPSG:25832+ellipsoidal). Both must not
/// be empty.
bool is_same_map(const Crs& a, const Crs& b);

/// Both state their heights, and not the same. Where one does not, it is unknown.
bool are_heights_apart(const Crs& a, const Crs& b);

/// Surfaces whose heights may be subtracted, as far as is known: the same map, heights not apart, or a CRS that is not stated.
bool are_comparable(const Crs& a, const Crs& b);

/// The same system with the same heights, whatever the text it is written as: nothing is to be transformed.
bool is_same_crs(const Crs& a, const Crs& b);

}  // namespace swath::core
