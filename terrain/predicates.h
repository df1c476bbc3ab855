// SPDX-License-Identifier: GPL-3.0-or-later
// Exact signs of the two determinants of planar Delaunay triangulation. Sums within their rounding error of zero are decided anew by
// CGAL's exact arithmetic; the bounds are those of Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric
// predicates", stage A.
#pragma once

#include <cmath>

namespace swath::terrain {

/// A place on the map, m.
struct Place {
  double x = 0.0, y = 0.0;
};

namespace exact {
int orientation(const Place& a, const Place& b, const Place& c);
int in_circle(const Place& a, const Place& b, const Place& c, const Place& d);
}  // namespace exact

constexpr double half_ulp = 0x1p-53;

/// 1 where a, b, c turn left, -1 right, 0 on one line.
inline int orientation(const Place& a, const Place& b, const Place& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right, bound = (3.0 + 16.0 * half_ulp) * half_ulp * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return exact::orientation(a, b, c);
}

/// For a, b, c that turn left: 1 where d lies inside their circle, -1 outside, 0 on it.
inline int in_circle(const Place& a, const Place& b, const Place& c, const Place& d) {
  const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const double aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  const double det = aa * (bxcy - cxby) + bb * (cxay - axcy) + cc * (axby - bxay);
  const double permanent =
      (std::abs(bxcy) + std::abs(cxby)) * aa + (std::abs(cxay) + std::abs(axcy)) * bb + (std::abs(axby) + std::abs(bxay)) * cc;
  const double bound = (10.0 + 96.0 * half_ulp) * half_ulp * permanent;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return exact::in_circle(a, b, c, d);
}

}  // namespace swath::terrain
