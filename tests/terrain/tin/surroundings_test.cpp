// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/surroundings.h"

#include "terrain/tin/tin.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

using Corners = std::array<std::array<double, 2>, 3>;

/// The triangles that touch a rectangle.
std::set<Corners> touching(const Tin& tin, const Rectangle& r) {
  std::set<Corners> out;
  for (const auto& t : tin.triangles) {
    // Separating axes: the rectangle's and the triangle's sides.
    std::array<Place, 3> p{tin.place(t[0]), tin.place(t[1]), tin.place(t[2])};
    if (orientation(p[0], p[1], p[2]) < 0) std::swap(p[1], p[2]);
    bool apart = std::max({p[0].x, p[1].x, p[2].x}) < r.west || std::min({p[0].x, p[1].x, p[2].x}) > r.east ||
                 std::max({p[0].y, p[1].y, p[2].y}) < r.south || std::min({p[0].y, p[1].y, p[2].y}) > r.north;
    for (size_t k = 0; k < 3 && !apart; ++k) {
      bool outside = true;
      for (const Place& c : {Place{r.west, r.south}, Place{r.west, r.north}, Place{r.east, r.south}, Place{r.east, r.north}})
        outside = outside && orientation(p[k], p[(k + 1) % 3], c) < 0;
      apart = outside;
    }
    if (apart) continue;
    Corners c;
    for (size_t k = 0; k < 3; ++k) c[k] = {tin.x[t[k]], tin.y[t[k]]};
    out.insert(c);
  }
  return out;
}

double flat(double, double) { return 0.0; }

TEST(Surroundings, APartIsThatOfTheWhole) {
  // Dense, sparse, with holes across the rectangle's border, at the points' edge, none inside, on a lattice.
  const core::Block dense = test::random_points(8000, 100.0, flat, 1);
  std::vector<std::uint32_t> holed, strip, ring;
  for (std::uint32_t i = 0; i < dense.size(); ++i) {
    const double x = dense.x[i], y = dense.y[i];
    if (std::hypot(x - 30.0, y - 50.0) > 12.0 && std::hypot(x - 62.0, y - 71.0) > 9.0) holed.push_back(i);
    if (x - y > 20.0) strip.push_back(i);
    if (x < 15.0 || y > 80.0) ring.push_back(i);
  }
  const Rectangle where{30.0, 30.0, 70.0, 70.0};
  for (const core::Block& b : {dense, core::select(dense, holed), core::select(dense, strip), core::select(dense, ring),
                               test::random_points(60, 100.0, flat, 2), test::lattice_points(100, flat), test::quantised(dense, 0.5)})
    for (const double radius : {3.0, 10.0, 25.0, std::numeric_limits<double>::infinity()}) {
      const Tin whole = triangulate(b, test::all_rows(b), radius), part = triangulate(b, test::all_rows(b), radius, where);
      EXPECT_EQ(touching(part, where), touching(whole, where)) << b.size() << " points, radius " << radius;
    }
}

TEST(Surroundings, FarPointsStayOut) {
  const core::Block b = test::random_points(20000, 100.0, flat, 3);
  const Tin part = triangulate(b, test::all_rows(b), 10.0, {40.0, 40.0, 60.0, 60.0});
  EXPECT_LT(part.x.size(), 4000u);
  EXPECT_GT(part.x.size(), 800u);
}

}  // namespace
}  // namespace swath::terrain
