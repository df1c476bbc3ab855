// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
Kernel::Point_2 point(const Place& p) { return {p.x, p.y}; }

}  // namespace

int orientation(const Place& a, const Place& b, const Place& c) {
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

int in_circle(const Place& a, const Place& b, const Place& c, const Place& d) {
  return static_cast<int>(CGAL::side_of_oriented_circle(point(a), point(b), point(c), point(d)));
}

}  // namespace swath::terrain
