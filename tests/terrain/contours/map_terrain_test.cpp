// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_terrain.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/terrain/map_lines.h"

namespace swath::terrain {
namespace {

constexpr core::Lattice fine{2.0, 0, 0, 250, 250};
// Hills with lesser ones on them: 25 m and 3 m high.
const test::Surface hills = [](double x, double y) {
  return 100.0 + 25.0 * std::sin(x / 70.0) * std::cos(y / 60.0) + 3.0 * std::sin(x / 19.0 + 1.0) * std::sin(y / 23.0);
};

MapTerrainOptions options(double cell) {
  MapTerrainOptions o;
  o.cell = cell;
  return o;
}

TEST(MapTerrain, ContoursGiveTheSurfaceBackWithinWhatTheIntervalAllowsAndSaySo) {
  double before = 0.0;
  for (const double interval : {2.0, 5.0}) {
    const MapTerrain t = map_terrain(test::map_of(hills, fine, interval), options(4.0));
    EXPECT_EQ(t.interval, interval);
    const core::Grid& g = t.surface.grid;
    const double rms = test::rms_over(g, hills, [](size_t) { return true; }).first;
    EXPECT_LT(rms, interval / 8.0);
    EXPECT_GT(rms, before);
    before = rms;
    double ratio = 0.0;
    size_t n = 0;
    for (int j = 0; j < g.lattice.ny; ++j)
      for (int i = 0; i < g.lattice.nx; ++i) {
        const size_t c = g.lattice.at(i, j);
        if (t.surface.part[c] == MapPart::none) continue;
        const double e =
            (static_cast<double>(g.height[c]) - hills(g.lattice.centre_x(i), g.lattice.centre_y(j))) / static_cast<double>(g.sigma[c]);
        ratio += e * e, ++n;
      }
    // Errors of a map are no noise: two or three of them make up a hill.
    EXPECT_NEAR(std::sqrt(ratio / static_cast<double>(n)), 1.0, 0.5) << interval;
    for (const MapError& e : t.errors) EXPECT_FALSE(e.assumed && e.part == "between contours");
  }
}

TEST(MapTerrain, TheContoursOwnSigmaIsAddedAndAnIntervalMayBeStated) {
  const MapContent map = test::map_of(hills, fine, 5.0);
  MapTerrainOptions o = options(5.0);
  const MapTerrain bare = map_terrain(map, o);
  o.sigma = 2.0, o.interval = 5.0;
  const MapTerrain stated = map_terrain(map, o);
  ASSERT_EQ(bare.surface.grid.sigma.size(), stated.surface.grid.sigma.size());
  for (size_t c = 0; c < bare.surface.part.size(); ++c)
    if (bare.surface.part[c] != MapPart::none) {
      ASSERT_NEAR(stated.surface.grid.sigma[c], std::hypot(bare.surface.grid.sigma[c], 2.0f), 1e-4);
    }
}

TEST(MapTerrain, FewLevelsAreAssumedAndSpotsAloneHaveNoSigma) {
  MapContent map;
  for (const double y : {0.0, 100.0}) map.lines.push_back({{{0, y, 10.0 + y / 10}, {200, y, 10.0 + y / 10}}, true, "contour"});
  const MapTerrain two = map_terrain(map, options(10.0));
  EXPECT_EQ(two.interval, 10.0);
  ASSERT_TRUE(two.errors[0].sigma.has_value());
  EXPECT_TRUE(two.errors[0].assumed);
  EXPECT_EQ(*two.errors[0].sigma, 2.5);
  MapContent spots;
  for (const double x : {0.0, 50.0, 100.0})
    for (const double y : {0.0, 60.0}) spots.spots.emplace_back(x, y, 0.1 * x);
  const MapTerrain bare = map_terrain(spots, options(10.0));
  EXPECT_TRUE(bare.surface.grid.sigma.empty());
  EXPECT_NEAR(bare.surface.grid.height[0], 0.5, 1e-4);
}

TEST(MapTerrain, AMapWithoutHeightsAndOneTooLargeAreRefused) {
  EXPECT_THROW(map_terrain({}, options(5.0)), core::Error);
  MapContent wide;
  wide.spots = {{0, 0, 1}, {1e6, 1e6, 2}};
  EXPECT_THROW(map_terrain(wide, options(1.0)), core::Error);
}

}  // namespace
}  // namespace swath::terrain
