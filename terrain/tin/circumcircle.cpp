// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/circumcircle.h"

#include <cmath>

namespace swath::terrain {

Circumcircle circumcircle(const Place& a, const Place& b, const Place& c) {
  const TriangleMeasures m(a, b, c);
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double ux = (cy * m.bb - by * m.cc) / (2.0 * m.twice_area), uy = (bx * m.cc - cx * m.bb) / (2.0 * m.twice_area);
  return {a.x + ux, a.y + uy, std::sqrt(m.aa) * std::sqrt(m.bb) * std::sqrt(m.cc) / (2.0 * std::abs(m.twice_area))};
}

}  // namespace swath::terrain
