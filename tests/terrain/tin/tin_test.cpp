// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/tin.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

using test::Made;

double wavy(double x, double y) { return 3.0 * std::sin(x / 7.0) + 2.0 * std::cos(y / 5.0); }

using Corners = std::array<std::array<double, 3>, 3>;
std::set<Corners> corners(const Tin& t) {
  std::set<Corners> out;
  for (const auto& v : t.triangles) {
    Corners c;
    for (size_t k = 0; k < 3; ++k) c[k] = {t.x[v[k]], t.y[v[k]], t.z[v[k]]};
    out.insert(c);
  }
  return out;
}

double area(const Tin& tin) {
  double sum = 0.0;
  for (const auto& t : tin.triangles)
    sum += 0.5 *
           std::abs((tin.x[t[1]] - tin.x[t[0]]) * (tin.y[t[2]] - tin.y[t[0]]) - (tin.y[t[1]] - tin.y[t[0]]) * (tin.x[t[2]] - tin.x[t[0]]));
  return sum;
}

TEST(Tin, TooFewOrCollinearPointsGiveNoTriangles) {
  Made m;
  EXPECT_EQ(triangulate(m.block, {}).size(), 0u);
  for (int n = 1; n <= 5; ++n) {
    m.add(n, 2.0 * n, 0.0);
    EXPECT_EQ(triangulate(m.block, test::all_rows(m.block)).size(), 0u) << n << " points on a line";
  }
  m.add(0.0, 5.0, 0.0);
  EXPECT_GT(triangulate(m.block, test::all_rows(m.block)).size(), 0u);
}

TEST(Tin, LowestOfDuplicatesStandsAndNonFinitePointsAreCounted) {
  Made m;
  m.add(0, 0, 5.0);
  m.add(0, 0, 4.0);
  m.add(0, 0, 6.0);
  m.add(3, 0, 1.0);
  m.add(0, 3, 1.0);
  m.add(1, std::nan(""), 1.0);
  const Tin tin = triangulate(m.block, test::all_rows(m.block));
  EXPECT_EQ(tin.duplicates.size(), 2u);
  EXPECT_EQ(tin.not_finite, 1u);
  ASSERT_EQ(tin.size(), 1u);
  EXPECT_EQ(tin.z[tin.triangles[0][0]], 4.0);
}

TEST(Tin, CocircularPointsAreCutFromTheSmallestVertex) {
  const core::Block b = test::lattice_points(12, wavy);
  const Tin tin = triangulate(b, test::all_rows(b));
  EXPECT_EQ(tin.size(), 2u * 12 * 12);
  for (const auto& t : tin.triangles) {
    // Every diagonal runs from the south-west corner, which is the first vertex, to the north-east one, which is the last.
    EXPECT_EQ(tin.x[t[2]] - tin.x[t[0]], 1.0);
    EXPECT_EQ(tin.y[t[2]] - tin.y[t[0]], 1.0);
  }
}

TEST(Tin, ManyPointsOnOneCircleMakeOneFan) {
  // Integer points on the circle of radius 65: exactly cocircular.
  Made m;
  for (int x = -65; x <= 65; ++x)
    for (int y = -65; y <= 65; ++y)
      if (x * x + y * y == 65 * 65) m.add(x, y, x + y);
  const Tin tin = triangulate(m.block, test::all_rows(m.block));
  ASSERT_EQ(m.block.size(), 36u);
  EXPECT_EQ(tin.size(), 34u);
  for (const auto& t : tin.triangles) {
    EXPECT_EQ(tin.x[t[0]], -65.0);
    EXPECT_EQ(tin.y[t[0]], 0.0);
  }
}

TEST(Tin, OrderOfPointsDoesNotMatter) {
  for (const core::Block& b : {test::lattice_points(20, wavy), test::quantised(test::random_points(4000, 20.0, wavy, 1), 0.1)}) {
    std::vector<std::uint32_t> rows = test::all_rows(b);
    const Tin first = triangulate(b, rows);
    EXPECT_EQ(corners(first).size(), first.size());
    for (unsigned seed = 0; seed < 5; ++seed) {
      std::shuffle(rows.begin(), rows.end(), std::mt19937(seed));
      EXPECT_EQ(corners(triangulate(b, rows)), corners(first));
    }
  }
}

TEST(Tin, CoversTheHullOnceAndIsDelaunay) {
  core::Block b = test::quantised(test::random_points(300, 10.0, wavy, 2), 0.25);
  Made frame;
  for (const double x : {0.0, 10.0})
    for (const double y : {0.0, 10.0}) frame.add(x, y, 0.0);
  core::append(b, frame.block);
  const Tin tin = triangulate(b, test::all_rows(b));
  EXPECT_FALSE(tin.duplicates.empty());
  EXPECT_NEAR(area(tin), 100.0, 1e-9);
  constexpr double rounding = 1e-9;  // of the circle's centre and radius, coordinates below 10 m
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
    const Circumcircle c = circumcircle(tin, t);
    if (c.radius > 1e3) continue;
    for (size_t v = 0; v < tin.x.size(); ++v) EXPECT_GE(std::hypot(tin.x[v] - c.x, tin.y[v] - c.y), c.radius - rounding);
  }
}

TEST(Tin, RadiusLimitKeepsExactlyTheSmallTriangles) {
  const core::Block b = test::random_points(2000, 50.0, wavy, 3);
  const Tin all = triangulate(b, test::all_rows(b)), some = triangulate(b, test::all_rows(b), 1.0);
  size_t small = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(all.size()); ++t) small += circumcircle(all, t).radius <= 1.0;
  EXPECT_EQ(some.size(), small);
  EXPECT_LT(some.size(), all.size());
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(some.size()); ++t) {
    const auto& v = some.triangles[t];
    for (size_t k = 0; k < 3; ++k)
      EXPECT_LE(std::hypot(some.x[v[k]] - some.x[v[(k + 1) % 3]], some.y[v[k]] - some.y[v[(k + 1) % 3]]), 2.0 + 1e-12);
  }
}

TEST(Tin, NeighboursShareTheEdgeOppositeToTheVertex) {
  const core::Block b = test::random_points(1000, 30.0, wavy, 4);
  const Tin tin = triangulate(b, test::all_rows(b));
  const auto& beside = tin.across;
  size_t none = 0;
  for (size_t t = 0; t < tin.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t n = beside[t][k];
      if (n < 0) {
        ++none;
        continue;
      }
      int shared = 0;
      for (const std::int32_t v : tin.triangles[n]) shared += v == tin.triangles[t][(k + 1) % 3] || v == tin.triangles[t][(k + 2) % 3];
      EXPECT_EQ(shared, 2);
      EXPECT_TRUE(beside[n][0] == static_cast<std::int32_t>(t) || beside[n][1] == static_cast<std::int32_t>(t) ||
                  beside[n][2] == static_cast<std::int32_t>(t));
    }
  // Euler: hull edges = 2 vertices - 2 - triangles.
  EXPECT_EQ(none, 2 * tin.x.size() - 2 - tin.size());
}

TEST(Tin, ConstraintsAreEdgesAndStandBeforePoints) {
  core::Block b = test::random_points(2000, 50.0, wavy, 21);
  b.x[0] = 10.0, b.y[0] = 10.0;
  Constraints c{{10.0, 40.0, 40.0}, {10.0, 20.0, 45.0}, {5.0, 6.0, 7.0}, {0.1f, 0.1f, 0.1f}, {{0, 1}, {1, 2}}};
  const Tin tin = triangulate(b, test::all_rows(b), c);
  EXPECT_EQ(tin.duplicates.size(), 1u);
  ASSERT_EQ(tin.constrained.size(), 2u);
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& t : tin.triangles)
    for (size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  for (const auto& e : tin.constrained) EXPECT_TRUE(edges.contains(e));
  for (size_t k = 0; k < tin.x.size(); ++k)
    if (tin.x[k] == 10.0 && tin.y[k] == 10.0) {
      EXPECT_EQ(tin.z[k], 5.0);
    }
  EXPECT_NEAR(area(triangulate(b, test::all_rows(b), c)), area(triangulate(b, test::all_rows(b))), 1.0);  // the hull, corners moved apart
}

TEST(Tin, CrossingConstraintsAreRefused) {
  const core::Block b = test::random_points(50, 10.0, wavy, 22);
  const Constraints c{{0, 10, 0, 10}, {0, 10, 10, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {{0, 1}, {2, 3}}};
  EXPECT_THROW(triangulate(b, test::all_rows(b), c), core::Error);
}

}  // namespace
}  // namespace swath::terrain
