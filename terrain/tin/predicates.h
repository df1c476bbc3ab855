// SPDX-License-Identifier: GPL-3.0-or-later
// Places on the map, and exact signs of the two determinants of planar Delaunay triangulation, by CGAL's filtered predicates.
#pragma once

namespace swath::terrain {

/// A place on the map, m.
struct Place {
  double x = 0.0, y = 0.0;
};

/// The order of (x, y).
inline bool is_before(const Place& a, const Place& b) { return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y)); }

/// 1 where a, b, c turn left, -1 right, 0 on one line.
int orientation(const Place& a, const Place& b, const Place& c);

/// For a, b, c that turn left: 1 where d lies inside their circle, -1 outside, 0 on it.
int in_circle(const Place& a, const Place& b, const Place& c, const Place& d);

}  // namespace swath::terrain
