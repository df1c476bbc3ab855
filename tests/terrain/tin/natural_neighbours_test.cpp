// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/natural_neighbours.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/natural_neighbor_coordinates_2.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "terrain/tin/tin_surface.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr double rounding = 1e-7;  // m: areas of slivers cancel

double hills(double x, double y) { return 40.0 + 5.0 * std::sin(x / 15.0) * std::cos(y / 12.0); }

TEST(NaturalNeighbours, AgreeWithCgal) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
  const core::Block b = test::random_points(2000, 50.0, hills, 31);
  const Tin tin = triangulate(b, test::all_rows(b));
  Delaunay dt;
  std::map<Kernel::Point_2, double> z;
  for (size_t k = 0; k < b.size(); ++k) {
    dt.insert(Kernel::Point_2(b.x[k], b.y[k]));
    z[Kernel::Point_2(b.x[k], b.y[k])] = b.z[k];
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(5.0, 45.0);
  std::vector<double> x, y;
  for (int k = 0; k < 2000; ++k) x.push_back(place(random)), y.push_back(place(random));
  const auto at = triangles_at(tin, x, y);
  const NaturalNeighbours here(tin);
  for (size_t k = 0; k < x.size(); ++k) {
    std::vector<std::pair<Kernel::Point_2, double>> weights;
    const auto norm = CGAL::natural_neighbor_coordinates_2(dt, Kernel::Point_2(x[k], y[k]), std::back_inserter(weights)).second;
    double expected = 0;
    for (const auto& [p, w] : weights) expected += w / norm * z[p];
    EXPECT_NEAR(here.height(at[k], x[k], y[k]), expected, rounding);
  }
}

TEST(NaturalNeighbours, PlanesAreExact) {
  const auto plane = [](double x, double y) { return 3.0 + 0.4 * x - 0.7 * y; };
  const core::Block b = test::random_points(500, 50.0, plane, 32);
  const Tin tin = triangulate(b, test::all_rows(b));
  const NaturalNeighbours here(tin);
  std::vector<double> x, y;
  for (int k = 0; k < 400; ++k) x.push_back(5.0 + 0.1 * k), y.push_back(7.0 + 0.09 * k);
  const auto at = triangles_at(tin, x, y);
  for (size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(here.height(at[k], x[k], y[k]), plane(x[k], y[k]), rounding);
}

TEST(NaturalNeighbours, AtTheEdgeThePlaneStands) {
  test::Made m;
  m.add(0, 0, 1), m.add(4, 0, 2), m.add(0, 4, 3);
  const Tin tin = triangulate(m.block, test::all_rows(m.block));
  EXPECT_EQ(NaturalNeighbours(tin).height(0, 1, 1), height_in(tin, 0, 1, 1));
}

}  // namespace
}  // namespace swath::terrain
