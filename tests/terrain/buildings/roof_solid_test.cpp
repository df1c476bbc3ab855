// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/roof_solid.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace swath::terrain {
namespace {

RoofPlane plane(double sx, double sy, double x, double y, double level) {
  RoofPlane p;
  p.slope = {sx, sy}, p.at = {x, y}, p.level = level;
  return p;
}

/// 20 m by 10 m, on its lowest planes.
Building house(std::vector<RoofPlane> planes) {
  Building b;
  b.outline.outer = {{0, 0}, {20, 0}, {20, 10}, {0, 10}};
  b.planes = std::move(planes);
  b.on_lowest = 1.0;
  return b;
}

size_t count_of(const Solid& s, Boundary kind) {
  return static_cast<size_t>(std::count_if(s.begin(), s.end(), [&](const SolidFace& f) { return f.kind == kind; }));
}

const RoofPlane south = plane(0, 0.5, 0, 0, 4.0), north = plane(0, -0.5, 0, 10, 4.0), west = plane(0.5, 0, 0, 0, 4.0),
                east = plane(-0.5, 0, 20, 0, 4.0);

TEST(RoofSolid, OfFlatPentAndGableRoofsHasTheirVolume) {
  const Solid flat = roof_solid(house({plane(0, 0, 0, 0, 6.0)}), 1.0);
  EXPECT_TRUE(is_closed(flat));
  EXPECT_NEAR(volume(flat), 200 * 5.0, 1e-6);
  EXPECT_NEAR(volume(roof_solid(house({plane(0.1, 0, 10, 5, 6.0)}), 1.0)), 200 * 5.0, 1e-6);
  const Solid gable = roof_solid(house({south, north}), 0.0);
  EXPECT_TRUE(is_closed(gable));
  EXPECT_EQ(count_of(gable, Boundary::roof), 2u);
  EXPECT_EQ(count_of(gable, Boundary::wall), 4u);
  EXPECT_NEAR(volume(gable), 200 * 4.0 + 200 * 2.5 / 2, 1e-6);
  EXPECT_EQ(std::max_element(gable.begin(), gable.end(), [](const auto& a, const auto& b) { return a.rings[0].size() < b.rings[0].size(); })
                ->rings[0]
                .size(),
            5u);
}

TEST(RoofSolid, OfAHipRoofIsClosedWherePlanesMeetInAPoint) {
  const Solid hip = roof_solid(house({south, north, west, east}), 0.0);
  EXPECT_TRUE(is_closed(hip));
  EXPECT_EQ(count_of(hip, Boundary::roof), 4u);
  EXPECT_NEAR(volume(hip), 200 * 4.0 + 10 * 10 * 2.5 / 2 + 10 * 10 * 2.5 / 3, 1e-6);
}

TEST(RoofSolid, WhatIsNotTheBuildingIsNotMade) {
  Building b = house({south, north});
  b.on_lowest = 0.8;
  EXPECT_TRUE(roof_solid(b, 0.0).empty());
  EXPECT_TRUE(roof_solid(house({}), 0.0).empty());
  EXPECT_TRUE(roof_solid(house({south, north}), 3.8).empty());  // no wall is left
  EXPECT_TRUE(roof_solid(house({south, north}), Building::none).empty());
  b = house({south, north});
  b.outline.outer = {{0, 0}, {20, 0}, {20, 10}, {10, 4}, {0, 10}};
  EXPECT_TRUE(roof_solid(b, 0.0).empty());
  b = house({south, north});
  b.outline.holes = {{{5, 3}, {5, 6}, {8, 6}, {8, 3}}};
  EXPECT_TRUE(roof_solid(b, 0.0).empty());
}

}  // namespace
}  // namespace swath::terrain
