// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/same_map.h"

namespace swath::core {

bool is_same_map(const Crs& a, const Crs& b) {
  const auto same_code = [](const Crs& l, const Crs& r) { return l.epsg() != 0 && l.epsg() == r.epsg(); };
  // The horizontal part of a CRS with ellipsoidal heights has lost its code; a file's WKT may differ from the registry's and keep the code.
  const Crs left = a.horizontal(), right = b.horizontal();
  return same_code(a, b) || same_code(left, right) || left.key() == right.key();
}

bool are_heights_apart(const Crs& a, const Crs& b) {
  if (a.heights() == Heights::unknown || b.heights() == Heights::unknown) return false;
  if (a.vertical_epsg() != 0 && a.vertical_epsg() == b.vertical_epsg()) return false;  // names differ from program to program
  return a.heights() != b.heights() || a.vertical_name() != b.vertical_name();
}

bool are_comparable(const Crs& a, const Crs& b) { return a.empty() || b.empty() || (is_same_map(a, b) && !are_heights_apart(a, b)); }

bool is_same_crs(const Crs& a, const Crs& b) {
  if (a.key() == b.key()) return true;
  return a.epsg() != 0 && a.epsg() == b.epsg() && a.heights() == b.heights() && a.vertical_epsg() == b.vertical_epsg() &&
         (a.vertical_epsg() != 0 || a.vertical_name() == b.vertical_name()) && a.vertical_metres_per_unit() == b.vertical_metres_per_unit();
}

}  // namespace swath::core
