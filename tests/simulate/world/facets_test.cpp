// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/facets.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "core/block.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

WorldOptions airfield() {
  WorldOptions w;
  w.scene = Scene::airfield;
  w.length = w.width = core::Metres(720);
  return w;
}

/// Farthest that the point lies outside the facet's edges, measured in its plane; negative inside.
double outside(const Facet& f, const Vector3d& p) {
  double worst = -1e300;
  for (size_t i = 0; i < f.corners.size(); ++i) {
    const Vector3d edge = (f.corners[(i + 1) % f.corners.size()] - f.corners[i]).normalized();
    worst = std::max(worst, edge.cross(f.normal).dot(p - f.corners[i]));
  }
  return worst;
}

TEST(Facets, CornersLieOnTheirPlaneAndTurnLeft) {
  for (const Scene scene : {Scene::airfield, Scene::town}) {
    WorldOptions w = airfield();
    w.scene = scene;
    const World world(w, 3, core::degrees(60), 900);
    const std::vector<Facet> facets = facets_of(world);
    ASSERT_GT(facets.size(), 60u);
    for (const Facet& f : facets) {
      ASSERT_GE(f.corners.size(), 3u) << f.name;
      EXPECT_NEAR(f.normal.norm(), 1.0, 1e-12);
      const size_t n = f.corners.size();
      for (size_t i = 0; i < n; ++i) {
        const Vector3d &a = f.corners[i], &b = f.corners[(i + 1) % n], &c = f.corners[(i + 2) % n];
        EXPECT_NEAR(f.normal.dot(a - f.corners[0]), 0.0, 1e-9) << f.name;
        EXPECT_GT(f.normal.dot((b - a).cross(c - b)), 0.0) << f.name;
      }
    }
  }
}

TEST(Facets, AHallHasTwoRoofsAndFourWalls) {
  const World world(airfield(), 3, core::degrees(60), 900);
  std::map<std::string, std::pair<int, int>> count;
  for (const Facet& f : facets_of(world)) {
    const std::string building = f.name.substr(0, f.name.find(f.roof ? " roof" : " wall"));
    (f.roof ? count[building].first : count[building].second)++;
    if (f.roof || building == "building") {
      EXPECT_EQ(f.corners.size(), 4u) << f.name;
      continue;
    }
    // Two gables of five corners, two walls of four; the lower ones on the ground.
    EXPECT_TRUE(f.corners.size() == 4 || f.corners.size() == 5) << f.name;
    int low = 0;
    for (const Vector3d& c : f.corners) low += std::abs(c.z() - world.relief().height(c.x(), c.y())) < 1e-9;
    EXPECT_EQ(low, 2) << f.name;
  }
  EXPECT_EQ(count.size(), 17u);
  for (const auto& [name, n] : count) EXPECT_EQ(n, (name == "building" ? std::pair{1, 4} : std::pair{2, 4})) << name;
}

TEST(Facets, WhatTheBeamMeetsOfABuildingLiesOnAFacet) {
  constexpr double on_facet = 1e-6;  // m
  const World world(airfield(), 4, core::degrees(60), 900);
  const std::vector<Facet> facets = facets_of(world);
  Random random(9, 9, 9);
  Echoes echoes;
  int roofs = 0, walls = 0;
  for (int i = 0; i < 120000; ++i) {
    const double off = random.uniform(0, 0.55), bearing = random.uniform(0, 2 * core::pi);
    const Vector3d d(std::sin(off) * std::cos(bearing), std::sin(off) * std::sin(bearing), -std::cos(off));
    const Vector3d foot(random.uniform(-360, 360), random.uniform(-360, 360), 605);
    world.trace({foot - 150 * d, d, Vector3d(0, 0, 1e-7)}, 1000, 0.0, random, echoes);
    ASSERT_EQ(echoes.count > 0, true);
    const Echo& last = echoes.echo[static_cast<size_t>(echoes.count - 1)];
    if (last.kind != core::point_class::building) continue;
    const Vector3d p = foot - 150 * d + last.s * d + Vector3d(0, 0, 1e-7 * last.s * last.s);
    double nearest = 1e300;
    bool roof = false;
    for (const Facet& f : facets) {
      if (outside(f, p) > on_facet) continue;
      const double gap = std::abs(f.normal.dot(p - f.corners[0]));
      if (gap < nearest) nearest = gap, roof = f.roof;
    }
    EXPECT_LT(nearest, on_facet);
    (roof ? roofs : walls)++;
  }
  EXPECT_GT(roofs, 1000);
  EXPECT_GT(walls, 100);
}

}  // namespace
}  // namespace swath::simulate
