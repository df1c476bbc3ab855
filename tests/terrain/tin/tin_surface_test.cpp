// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/tin_surface.h"

#include <gtest/gtest.h>

#include "tests/terrain/made.h"
#include "tests/terrain/tin/heights_at.h"

namespace swath::terrain {
namespace {

double plane(double x, double y) { return 12.0 + 0.3 * x - 0.2 * y; }

TEST(TinSurface, PlaneIsExact) {
  constexpr double rounding = 1e-9;  // of sums of products below 100 m
  const core::Block b = test::random_points(3000, 100.0, plane, 1);
  const Tin tin = triangulate(b, test::all_rows(b), 10.0);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(5.0, 95.0);
  std::vector<double> x, y;
  for (int i = 0; i < 2000; ++i) x.push_back(place(random)), y.push_back(place(random));
  const std::vector<double> h = heights_at(tin, x, y);
  for (size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(h[i], plane(x[i], y[i]), rounding);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t)
    if (circumcircle(tin, t).radius < 3.0) {
      ASSERT_NEAR(gradient(tin, t).x(), 0.3, 1e-6);
      ASSERT_NEAR(gradient(tin, t).y(), -0.2, 1e-6);
    }
}

TEST(TinSurface, ErrorOnASphereIsWithinTheBoundOfLinearInterpolation) {
  // |error| <= K/2 (r^2 - d^2), K the largest second derivative: here below 1.2 / radius within 200 m of the top.
  constexpr double radius = 1000.0;
  const auto sphere = [](double x, double y) { return std::sqrt(radius * radius - (x - 100) * (x - 100) - (y - 100) * (y - 100)); };
  const core::Block b = test::random_points(5000, 200.0, sphere, 3);
  const Tin tin = triangulate(b, test::all_rows(b), 20.0);
  const core::Lattice window{1.0, 500010, 4600010, 180, 180};
  const auto at = triangles_at_centres(tin, b.origin, window);
  double largest = 0.0;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const std::int32_t t = at[window.at(i, j)];
      ASSERT_GE(t, 0);
      const double x = window.centre_x(i) - b.origin.x(), y = window.centre_y(j) - b.origin.y();
      const Circumcircle c = circumcircle(tin, t);
      const double bound = 0.5 * (1.2 / radius) * (c.radius * c.radius - (x - c.x) * (x - c.x) - (y - c.y) * (y - c.y));
      const double error = std::abs(height_in(tin, t, x, y) - sphere(x, y));
      ASSERT_LE(error, bound + 1e-9);
      largest = std::max(largest, error);
    }
  EXPECT_GT(largest, 1e-4);
}

TEST(TinSurface, CentresOnEdgesBelongToTheFirstTriangleAndNoneIsMissed) {
  // Points on half metres: all cell centres are vertices or lie on diagonals.
  test::Made m;
  for (int j = 0; j <= 20; ++j)
    for (int i = 0; i <= 20; ++i) m.add(i, j, plane(i, j));
  const Tin tin = triangulate(m.block, test::all_rows(m.block));
  const core::Lattice window{1.0, 500000, 4600000, 20, 20};
  const auto at = triangles_at_centres(tin, m.block.origin, window);
  std::vector<double> x, y;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      x.push_back(window.centre_x(i) - m.block.origin.x());
      y.push_back(window.centre_y(j) - m.block.origin.y());
    }
  for (const std::int32_t t : at) ASSERT_GE(t, 0);
  EXPECT_EQ(at, triangles_at(tin, x, y));
  for (size_t k = 0; k < at.size(); ++k) {
    // Of the two triangles at a diagonal the one with the north-west corner comes first: (0,0) (0,1) (1,1).
    const auto& v = tin.triangles[at[k]];
    EXPECT_EQ(tin.x[v[1]], tin.x[v[0]]);
  }
}

TEST(TinSurface, LongThinTrianglesAreFilledCompletely) {
  test::Made m;
  m.add(0.0, 0.0, 0.0);
  m.add(200.0, 0.7, 0.0);
  m.add(199.0, 3.0, 0.0);
  m.add(3.0, 180.0, 0.0);
  const Tin tin = triangulate(m.block, test::all_rows(m.block));
  const core::Lattice window{1.0, 499990, 4599990, 230, 210};
  const auto at = triangles_at_centres(tin, m.block.origin, window);
  std::vector<double> x, y;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      x.push_back(window.centre_x(i) - m.block.origin.x());
      y.push_back(window.centre_y(j) - m.block.origin.y());
    }
  EXPECT_EQ(at, triangles_at(tin, x, y));
  size_t covered = 0;
  for (size_t k = 0; k < x.size(); ++k) covered += at[k] >= 0;
  EXPECT_GT(covered, 17000u);  // the hull's area is some 18 000 m2
}

TEST(TinSurface, OutsideIsNothing) {
  const core::Block b = test::random_points(100, 10.0, plane, 5);
  const Tin tin = triangulate(b, test::all_rows(b));
  const auto h = heights_at(tin, {-1.0, 5.0, std::nan("")}, {5.0, 5.0, 5.0});
  EXPECT_TRUE(std::isnan(h[0]));
  EXPECT_FALSE(std::isnan(h[1]));
  EXPECT_TRUE(std::isnan(h[2]));
  EXPECT_TRUE(std::isnan(heights_at(Tin{}, {0.0}, {0.0})[0]));
}

}  // namespace
}  // namespace swath::terrain
