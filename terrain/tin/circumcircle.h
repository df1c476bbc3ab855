// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "terrain/tin/predicates.h"

namespace swath::terrain {

/// Radius and centre of the circle through a triangle's vertices, m.
struct Circumcircle {
  double x = 0.0, y = 0.0, radius = 0.0;
};
/// Of places that ascend in (x, y).
Circumcircle circumcircle(const Place& a, const Place& b, const Place& c);

/// Squares of the sides of a triangle whose vertices ascend, and twice its area (signed).
struct TriangleMeasures {
  double aa, bb, cc, twice_area;
  TriangleMeasures(const Place& a, const Place& b, const Place& c) {
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    twice_area = bx * cy - by * cx;
    bb = bx * bx + by * by;
    cc = cx * cx + cy * cy;
    aa = (bx - cx) * (bx - cx) + (by - cy) * (by - cy);
  }
  /// Whether the circumradius is over `radius`; not where rounding leaves no area and no limit is set.
  bool wider_than(double radius) const { return aa * bb * cc > 4.0 * radius * radius * twice_area * twice_area; }
};

}  // namespace swath::terrain
