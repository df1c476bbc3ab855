// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_surface.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/terrain/map_lines.h"

namespace swath::terrain {
namespace {

constexpr core::Lattice fine{2.0, 0, 0, 200, 200}, cells{5.0, 0, 0, 80, 80};  // 400 m by 400 m
const test::Surface hills = [](double x, double y) { return 100.0 + 20.0 * std::sin(x / 60.0) * std::cos(y / 50.0); };

MapSurfaceOptions every(double interval) {
  MapSurfaceOptions o;
  o.interval = interval;
  return o;
}

TEST(MapSurface, FlatTrianglesAreFilledAndTheRestIsTheTriangulation) {
  const MapContent map = test::map_of(hills, fine, 5.0);
  MapSurfaceOptions o = every(5.0);
  const MapSurface filled = map_surface(map, cells, o);
  o.keep_flats = true;
  const MapSurface kept = map_surface(map, cells, o);
  EXPECT_GT(filled.flats.parts, 4u);  // a top or pit each, and valleys
  EXPECT_EQ(kept.flats.parts, 0u);
  const auto in_flats = [&](size_t c) { return filled.part[c] == MapPart::flat; };
  for (size_t c = 0; c < cells.size(); ++c) {
    EXPECT_EQ(kept.part[c] == MapPart::kept, in_flats(c));
    if (filled.part[c] == MapPart::between) {
      EXPECT_EQ(filled.grid.height[c], kept.grid.height[c]);
    }
  }
  const auto [rms_kept, n] = test::rms_over(kept.grid, hills, in_flats);
  const double rms = test::rms_over(filled.grid, hills, in_flats).first;
  EXPECT_GT(n, 300u);
  EXPECT_GT(rms_kept, 1.0);         // a fifth of the interval
  EXPECT_LT(rms, 0.35 * rms_kept);  // the hills are smooth: least bending finds most of it
  EXPECT_LT(test::rms_over(filled.grid, hills, [&](size_t c) { return filled.part[c] == MapPart::between; }).first, 0.5);
}

TEST(MapSurface, NoCellReachesTheNextLevel) {
  // A needle on a slope so steep that least bending would shoot over.
  const test::Surface needle = [](double x, double y) { return 100.0 - 0.9 * std::hypot(x - 201.0, y - 199.0); };
  const MapSurface s = map_surface(test::map_of(needle, fine, 40.0), cells, every(40.0));
  float highest = 0.0f;
  for (size_t c = 0; c < cells.size(); ++c)
    if (s.part[c] == MapPart::flat) highest = std::max(highest, s.grid.height[c]);
  EXPECT_GT(highest, 81.0f);
  EXPECT_LE(highest, 80.0f + 36.0f);
}

TEST(MapSurface, SpotHeightsAndBreaklinesHoldAndContoursWinWhereBreaklinesCrossThem) {
  MapContent map;
  for (const double y : {0.0, 100.0}) map.lines.push_back({{{0, y, 10.0 + y / 10}, {200, y, 10.0 + y / 10}}, true, "contour"});
  map.lines.push_back({{{100, -10, 4.0}, {100, 20, 4.1}, {100, 80, 4.4}, {100, 110, 4.5}}, false, "ditch"});
  map.spots.emplace_back(42.5, 52.5, 30.0);
  const core::Lattice l{5.0, 0, 0, 40, 20};
  const MapSurface s = map_surface(map, l, every(10.0));
  EXPECT_NEAR(s.grid.height[l.at(8, 10)], 30.0, 1e-3);  // the centre of a cell
  EXPECT_LT(s.grid.height[l.at(20, 10)], 6.0);          // beside the ditch
  EXPECT_NEAR(s.grid.height[l.at(39, 0)], 10.25, 0.3);
}

TEST(MapSurface, ContoursThatCrossAtDifferentHeightsAreRefused) {
  MapContent map;
  map.lines.push_back({{{0, 0, 10}, {100, 100, 10}}, true, "sheet, line 1"});
  map.lines.push_back({{{0, 100, 20}, {100, 0, 20}}, true, "sheet, line 2"});
  EXPECT_THROW(map_surface(map, {5.0, 0, 0, 20, 20}, every(10.0)), core::Error);
}

TEST(MapSurface, GapsWiderThanTheLongestTriangleAreVoid) {
  const MapContent map = test::map_of([](double x, double) { return x < 100.0 ? 0.1 * x : 0.1 * std::max(x - 200.0, 100.0); }, fine, 2.0);
  MapSurfaceOptions o = every(2.0);
  o.max_edge = 60.0;
  const MapSurface s = map_surface(map, cells, o);
  EXPECT_EQ(s.part[cells.at(40, 40)], MapPart::none);
  EXPECT_EQ(s.grid.reason[cells.at(40, 40)], core::Void::no_data);
  EXPECT_EQ(s.part[cells.at(10, 40)], MapPart::between);
}

}  // namespace
}  // namespace swath::terrain
