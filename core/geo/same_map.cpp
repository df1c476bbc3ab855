// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/same_map.h"

namespace swath::core {

bool is_same_map(const Crs& a, const Crs& b) {
  // The horizontal part of a CRS with ellipsoidal heights has lost its code.
  return (a.epsg() != 0 && a.epsg() == b.epsg()) || a.horizontal().key() == b.horizontal().key();
}

}  // namespace swath::core
