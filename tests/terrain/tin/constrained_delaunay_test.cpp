// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/constrained_delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/error.h"

namespace swath::terrain {
namespace {

using Edges = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// Within the hull; every neighbour must know of its neighbour.
std::vector<std::array<std::int32_t, 3>> triangles(const ConstrainedFaces& c) {
  std::vector<std::array<std::int32_t, 3>> out;
  for (size_t f = 0; f < c.faces.size(); ++f) {
    for (const std::int32_t n : c.faces[f].n) {
      const auto& back = c.faces[static_cast<size_t>(n)].n;
      EXPECT_EQ(std::count(back.begin(), back.end(), static_cast<std::int32_t>(f)), 1);
    }
    if (c.faces[f].is_finite()) out.push_back(c.faces[f].v);
  }
  return out;
}

TEST(ConstrainedDelaunay, HoldsTheEdgeThatIsNotDelaunay) {
  // Of this flat diamond the short diagonal is Delaunay.
  const std::vector<Place> places{{0, 0}, {5, 1}, {10, 0}, {5, -1}};
  const auto has = [](const ConstrainedFaces& c, std::int32_t a, std::int32_t b) {
    const auto all = triangles(c);
    return std::all_of(all.begin(), all.end(), [&](const auto& t) {
      return std::find(t.begin(), t.end(), a) != t.end() && std::find(t.begin(), t.end(), b) != t.end();
    });
  };
  EXPECT_TRUE(has(constrained_delaunay(places, {}, {0, 0}), 1, 3));
  const ConstrainedFaces held = constrained_delaunay(places, {{2, 0}}, {0, 0});
  EXPECT_EQ(triangles(held).size(), 2u);
  EXPECT_TRUE(has(held, 0, 2));
  EXPECT_EQ(held.held, (Edges{{0, 2}}));
}

TEST(ConstrainedDelaunay, PolygonsAreNotJoinedAcrossAConstraint) {
  const std::vector<Place> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const ConstrainedFaces held = constrained_delaunay(square, {{1, 3}}, {0, 0});
  for (const auto& t : triangles(held))
    EXPECT_TRUE(std::find(t.begin(), t.end(), 1) != t.end() && std::find(t.begin(), t.end(), 3) != t.end());
  for (const auto& t : triangles(constrained_delaunay(square, {}, {0, 0}))) EXPECT_EQ(*std::min_element(t.begin(), t.end()), 0);
}

TEST(ConstrainedDelaunay, BothSidesOfAConstraintAreCutInOneCircle) {
  // On a circle of radius 5; the held diagonal leaves two polygons of four corners.
  const std::vector<Place> hexagon{{5, 0}, {3, 4}, {-3, 4}, {-5, 0}, {-3, -4}, {3, -4}};
  const ConstrainedFaces c = constrained_delaunay(hexagon, {{0, 3}}, {0, 0});
  const auto all = triangles(c);
  ASSERT_EQ(all.size(), 4u);
  for (const auto& t : all) EXPECT_TRUE(std::find(t.begin(), t.end(), 3) != t.end()) << "corner 3 lies farthest west";
  EXPECT_EQ(c.held, (Edges{{0, 3}}));
}

TEST(ConstrainedDelaunay, CrossingEdgesAreNamed) {
  try {
    constrained_delaunay({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {{0, 1}, {2, 3}}, {100, 200});
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.where().find("x 102"), std::string::npos) << e.where();
  }
}

}  // namespace
}  // namespace swath::terrain
