// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/line_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/error.h"

namespace swath::terrain {
namespace {

using Eigen::Vector3d;

constexpr double rounding = 1e-9;  // m

NetworkLine line(std::vector<Vector3d> vertices, const std::string& place, bool yields = false) {
  return {std::move(vertices), place, 0.05, yields};
}

/// Height of the network at a vertex; NaN where there is none.
double height_at(const Constraints& c, double x, double y) {
  for (size_t k = 0; k < c.x.size(); ++k)
    if (std::hypot(c.x[k] - x, c.y[k] - y) < 1e-6) return c.z[k];
  return std::nan("");
}

double longest(const Constraints& c) {
  double l = 0;
  for (const auto& [a, b] : c.edges)
    l = std::max(l, std::hypot(c.x[static_cast<size_t>(a)] - c.x[static_cast<size_t>(b)],
                               c.y[static_cast<size_t>(a)] - c.y[static_cast<size_t>(b)]));
  return l;
}

double total(const Constraints& c) {
  double l = 0;
  for (const auto& [a, b] : c.edges)
    l += std::hypot(c.x[static_cast<size_t>(a)] - c.x[static_cast<size_t>(b)], c.y[static_cast<size_t>(a)] - c.y[static_cast<size_t>(b)]);
  return l;
}

TEST(LineNetwork, PiecesAreShortAndHeightsLinear) {
  const Constraints c = line_network({line({{0, 0, 10}, {30, 40, 60}}, "a")}, {});
  EXPECT_EQ(c.edges.size(), 25u);
  EXPECT_NEAR(total(c), 50.0, rounding);
  EXPECT_LE(longest(c), 2.0 + rounding);
  for (size_t k = 0; k < c.x.size(); ++k) EXPECT_NEAR(c.z[k], 10.0 + std::hypot(c.x[k], c.y[k]), rounding);
}

TEST(LineNetwork, CrossingAtOneHeightGivesAVertex) {
  const Constraints c = line_network({line({{0, 5, 3}, {10, 5, 3}}, "a"), line({{5, 0, 3}, {5, 10.3, 3}}, "b")}, {});
  EXPECT_NEAR(height_at(c, 5, 5), 3.0, rounding);
  EXPECT_NEAR(total(c), 20.3, rounding);
}

TEST(LineNetwork, CrossingAtDifferentHeightsNamesBothAndThePlace) {
  try {
    line_network({line({{0, 5, 3}, {10, 5, 3}}, "roads.gpkg: feature 4"), line({{5, 0, 3.2}, {5, 10, 3.2}}, "walls.dxf: feature 9")}, {},
                 {500000, 4600000, 100});
    FAIL() << "no error";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.where()).find("roads.gpkg: feature 4"), std::string::npos) << e.where();
    EXPECT_NE(std::string(e.where()).find("walls.dxf: feature 9"), std::string::npos);
    const std::string what = e.what();
    for (const char* part : {"500005", "4600005", "103 m", "103.2 m"})
      EXPECT_NE(what.find(part), std::string::npos) << part << ": " << what;
  }
}

TEST(LineNetwork, EndOnALineAtAnotherHeightIsAnErrorToo) {
  EXPECT_THROW(line_network({line({{0, 0, 3}, {10, 0, 3}}, "a"), line({{5, 0, 4}, {5, 8, 4}}, "b")}, {}), core::Error);
  EXPECT_THROW(line_network({line({{0, 0, 3}, {10, 0, 3}}, "a"), line({{10, 0, 4}, {15, 8, 4}}, "b")}, {}), core::Error);
  const Constraints c = line_network({line({{0, 0, 3}, {10, 0, 3}}, "a"), line({{5, 0, 3}, {5, 8, 4}}, "b")}, {});
  EXPECT_NEAR(total(c), 18.0, rounding);
}

TEST(LineNetwork, EqualHeightsMeetAtToleranceZero) {
  // On both lines the height is 0.1 x, rounded by different ways.
  NetworkOptions o;
  o.tolerance = core::Metres(0.0);
  const auto at = [](double x, double y) { return Vector3d(x, y, 0.1 * x + 0.03 * y); };
  for (int k = 1; k < 40; ++k)
    EXPECT_NO_THROW(line_network({line({at(0, 0), at(70.1, 33.3)}, "a"), line({at(1.7 * k, 40.3), at(2.1 * k, -11.9)}, "b")}, o)) << k;
  EXPECT_THROW(line_network({line({{0, 0, 3}, {10, 0, 3}}, "a"), line({{5, -5, 3.0001}, {5, 8, 3.0001}}, "b")}, o), core::Error);
}

TEST(LineNetwork, LinesThatCannotBeNodedAreNamedWithThePlace) {
  int refused = 0;
  for (unsigned seed = 0; seed < 300 && refused < 3; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> near(0.0, 0.008), along(0.0, 1.0);
    std::vector<NetworkLine> lines{line({{900, 900, 1}, {950, 900, 1}}, "far.gpkg: feature 1")};
    for (int k = 0; k < 40; ++k)
      lines.push_back(
          line({{along(random), near(random), 1}, {along(random), near(random), 1}}, "close.gpkg: feature " + std::to_string(k)));
    try {
      line_network(lines, {}, {500000, 4600000, 0});
    } catch (const core::Error& e) {
      ++refused;
      EXPECT_EQ(e.where().find("far.gpkg"), std::string::npos) << e.text();
      EXPECT_NE(e.where().find("close.gpkg: feature "), std::string::npos) << e.text();
      EXPECT_NE(std::string(e.what()).find("x 50000"), std::string::npos) << e.text();
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(LineNetwork, DerivedHeightsYield) {
  for (const bool first : {true, false}) {
    std::vector<NetworkLine> lines{line({{0, 5, 3}, {10, 5, 3}}, "lake", true), line({{5, 0, 4}, {5, 10, 4}}, "wall")};
    if (!first) std::swap(lines[0], lines[1]);
    EXPECT_NEAR(height_at(line_network(lines, {}), 5, 5), 4.0, rounding);
  }
}

TEST(LineNetwork, CommonStretchesStandOnceWhicheverWayTheyRun) {
  const Constraints one = line_network({line({{0, 0, 1}, {10, 0, 1}, {10, 10, 1}}, "a")}, {});
  const Constraints two =
      line_network({line({{0, 0, 1}, {10, 0, 1}, {10, 10, 1}}, "a"), line({{10, 10, 1}, {10, 0, 1}, {5, 0, 1}}, "b")}, {});
  EXPECT_NEAR(total(two), total(one), rounding);
}

TEST(LineNetwork, EdgesMeetAtVerticesOnly) {
  // A plane holds all lines, so every crossing agrees in height.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  std::vector<NetworkLine> lines;
  const auto at = [&](double x, double y) { return Vector3d(x, y, 0.1 * x - 0.2 * y); };
  for (int k = 0; k < 40; ++k)
    lines.push_back(line({at(place(random), place(random)), at(place(random), place(random))}, "l" + std::to_string(k)));
  NetworkOptions o;
  o.spacing = core::Metres(5.0);
  const Constraints c = line_network(lines, o);
  EXPECT_LE(longest(c), 5.0 + rounding);
  for (size_t k = 0; k < c.x.size(); ++k) EXPECT_NEAR(c.z[k], 0.1 * c.x[k] - 0.2 * c.y[k], 1e-6);
  const auto point = [&](std::int32_t v) { return Eigen::Vector2d(c.x[static_cast<size_t>(v)], c.y[static_cast<size_t>(v)]); };
  const auto side = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
    return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
  };
  int crossings = 0;
  for (size_t i = 0; i < c.edges.size(); ++i)
    for (size_t j = i + 1; j < c.edges.size(); ++j) {
      const auto [a, b] = c.edges[i];
      const auto [p, q] = c.edges[j];
      if (a == p || a == q || b == p || b == q) continue;
      crossings += side(point(a), point(b), point(p)) * side(point(a), point(b), point(q)) < 0 &&
                   side(point(p), point(q), point(a)) * side(point(p), point(q), point(b)) < 0;
    }
  EXPECT_EQ(crossings, 0);
}

TEST(LineNetwork, EdgesInABox) {
  const Constraints c = line_network({line({{0, 0, 1}, {100, 0, 1}}, "a")}, {});
  const Constraints part = edges_in(c, 10.5, -1, 20.5, 1);
  EXPECT_EQ(part.edges.size(), 6u);
  EXPECT_EQ(part.x.size(), 7u);
  EXPECT_TRUE(edges_in(c, 0, 5, 100, 6).empty());
}

}  // namespace
}  // namespace swath::terrain
