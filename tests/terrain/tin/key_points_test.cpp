// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/key_points.h"

#include <gtest/gtest.h>

#include "terrain/dtm.h"
#include "terrain/tin/tin_surface.h"
#include "tests/terrain/made.h"
#include "tests/terrain/tin/heights_at.h"

namespace swath::terrain {
namespace {

constexpr double rounding = 1e-9;  // of a plane's height within triangles of some 10 m

double hills(double x, double y) { return 40.0 + 5.0 * std::sin(x / 15.0) * std::cos(y / 12.0); }
double steep(double x, double y) { return 1.2 * x + 20.0 * std::sin(y / 25.0) + (x + 0.3 * y > 70.0 ? 15.0 : 0.0); }
double flat(double, double) { return 7.0; }

core::Block with_noise(core::Block b, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  for (double& z : b.z) z += noise(random);
  return b;
}

core::Block holed(const core::Block& b, double radius) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < b.size(); ++i)
    if (std::hypot(b.x[i] - 40.0, b.y[i] - 45.0) > radius) rows.push_back(i);
  return core::select(b, rows);
}

core::Block with_flags(core::Block b) {
  core::add_columns(b, {core::Column::flags});
  return b;
}

std::vector<std::uint32_t> key_rows(const core::Block& b) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < b.size(); ++i)
    if (b.flags[i] & core::flag::key_point) rows.push_back(i);
  return rows;
}

KeyPointOptions options() {
  KeyPointOptions o;
  o.cell = core::Metres(30.0);
  o.max_edge = core::Metres(12.0);
  return o;
}

TEST(KeyPoints, EveryPointIsWithinTheTolerance) {
  for (const double tolerance : {0.05, 0.3})
    for (const core::Block& made :
         {test::random_points(20000, 80.0, hills, 1), with_noise(test::random_points(20000, 80.0, hills, 2), 0.03, 3),
          test::random_points(20000, 80.0, steep, 4), holed(test::random_points(20000, 80.0, steep, 5), 15.0),
          test::lattice_points(80, hills), test::quantised(test::random_points(9000, 80.0, hills, 6), 0.25),
          test::random_points(300, 80.0, hills, 7), test::random_points(20000, 80.0, flat, 8)}) {
      core::Block b = with_flags(made);
      KeyPointOptions o = options();
      o.tolerance = core::Metres(tolerance);
      const KeyPointCounts n = mark_key_points(b, b.size(), o);
      const std::vector<std::uint32_t> rows = key_rows(b);
      EXPECT_EQ(n.key, rows.size());
      EXPECT_EQ(n.terrain, b.size());
      const double radius = 0.5 * o.max_edge.value;
      const Tin all = triangulate(b, test::all_rows(b), radius), key = triangulate(b, rows, radius);
      // All vertices, as of points at one place only the lowest counts, those of no triangle left aside.
      const std::vector<double> height = heights_at(key, all.x, all.y);
      const std::vector<std::int32_t> in = triangles_at(all, all.x, all.y);
      double farthest = 0.0;
      for (size_t v = 0; v < all.x.size(); ++v) {
        if (in[v] < 0) continue;
        ASSERT_FALSE(std::isnan(height[v])) << v;
        farthest = std::max(farthest, std::abs(height[v] - all.z[v]));
      }
      EXPECT_LE(farthest, tolerance + rounding);
      EXPECT_NEAR(n.farthest, farthest, rounding);
      // The same cover.
      const core::Lattice window{1.0, 499998, 4599998, 84, 84};
      const auto before = triangles_at_centres(all, b.origin, window), after = triangles_at_centres(key, b.origin, window);
      for (size_t c = 0; c < before.size(); ++c) EXPECT_EQ(before[c] < 0, after[c] < 0);
    }
}

TEST(KeyPoints, SmoothTerrainNeedsFew) {
  core::Block b = with_flags(test::random_points(80000, 100.0, hills, 9));
  KeyPointOptions o;
  o.cell = core::Metres(50.0);
  const KeyPointCounts n = mark_key_points(b, b.size(), o);
  EXPECT_LT(static_cast<double>(n.key), 0.08 * static_cast<double>(n.terrain));
  o.tolerance = core::Metres(0.02);
  EXPECT_GT(mark_key_points(b, b.size(), o).key, n.key);
}

TEST(KeyPoints, SameForEveryTiling) {
  const KeyPointOptions o = options();
  for (const core::Block& made :
       {holed(with_noise(test::random_points(12000, 80.0, steep, 11), 0.05, 12), 14.0), test::lattice_points(80, hills)}) {
    core::Block whole = with_flags(made);
    mark_key_points(whole, whole.size(), o);
    for (const double side : {17.0, 40.0}) {
      size_t seen = 0;
      for (double y0 = 0.0; y0 <= 80.0; y0 += side)
        for (double x0 = 0.0; x0 <= 80.0; x0 += side) {
          std::vector<std::uint32_t> rows, around;
          const double h = halo(o);
          for (std::uint32_t i = 0; i < whole.size(); ++i) {
            const double x = whole.x[i], y = whole.y[i];
            if (x >= x0 && x < x0 + side && y >= y0 && y < y0 + side)
              rows.push_back(i);
            else if (x >= x0 - h && x < x0 + side + h && y >= y0 - h && y < y0 + side + h)
              around.push_back(i);
          }
          const size_t own = rows.size();
          rows.insert(rows.end(), around.begin(), around.end());
          core::Block tile = core::select(with_flags(made), rows);
          mark_key_points(tile, own, o);
          for (size_t k = 0; k < own; ++k) ASSERT_EQ(tile.flags[k], whole.flags[rows[k]]) << side;
          seen += own;
        }
      EXPECT_EQ(seen, whole.size());
    }
  }
}

TEST(KeyPoints, OtherClassesAndOldFlagsGo) {
  core::Block b = with_flags(test::random_points(500, 20.0, flat, 13));
  b.classification[7] = core::point_class::building;
  b.flags[7] = core::flag::key_point | core::flag::overlap;
  mark_key_points(b, b.size(), options());
  EXPECT_EQ(b.flags[7], core::flag::overlap);
  core::Block none = with_flags(core::Block{});
  EXPECT_EQ(mark_key_points(none, 0, options()).key, 0u);
}

TEST(KeyPoints, TheTerrainModelCanBeMadeOfThemAlone) {
  core::Block b = with_flags(test::random_points(20000, 80.0, hills, 14));
  KeyPointOptions k = options();
  mark_key_points(b, b.size(), k);
  DtmOptions o;
  o.max_edge = k.max_edge;
  o.key_points = true;
  EXPECT_EQ(terrain_rows(b, o), key_rows(b));
  b.flags.clear();
  EXPECT_TRUE(terrain_rows(b, o).empty());
}

}  // namespace
}  // namespace swath::terrain
