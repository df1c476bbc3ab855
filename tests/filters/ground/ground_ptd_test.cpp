// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_ptd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

auto run(const PtdOptions& o = {}) {
  return [o](core::Block& b, size_t own) { return classify_ground_ptd(b, own, o); };
}

/// Points on a square grid of a metre over exact terrain.
core::Block grid(int side, const std::function<double(double, double)>& terrain) {
  core::Block b;
  b.origin = {512300.0, 5402100.0, 0.0};
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      b.x.push_back(i);
      b.y.push_back(j);
      b.z.push_back(terrain(i, j));
    }
  core::add_columns(b, {core::Column::time, core::Column::classification});
  return b;
}

size_t ground_of(const core::Block& b) {
  return static_cast<size_t>(std::count(b.classification.begin(), b.classification.end(), core::point_class::ground));
}

TEST(Ptd, MadeScenesComeOutNearlyWhole) {
  test::expect_within({{"flat", 0.1, 0},
                       {"slope", 0.1, 0},
                       {"town", 0.1, 0.1},
                       {"forest", 0.5, 0.5},
                       {"water", 0.1, 0},
                       {"void", 0.1, 0},
                       {"strip_edge", 0.1, 0},
                       {"scarp", 1.5, 0}},
                      run());
}

TEST(Ptd, TheAngleAtTheNearestVertexDecides) {
  // 100 m above the datum everywhere but for one point in the middle of a square of four, 0.707 m from each.
  constexpr double away = 0.70710678;
  const PtdOptions o;
  const double limit = o.scatter.value + away * std::tan(o.angle.value);  // a little less with the distance in space
  for (const double above : {0.9 * limit, 2.0 * limit}) {
    core::Block b = grid(90, [](double, double) { return 100.0; });
    core::resize(b, b.size() + 1);
    b.x.back() = b.y.back() = 44.5;
    b.z.back() = 100.0 + above;
    classify_ground_ptd(b, b.size(), o);
    EXPECT_EQ(ground_of(b), b.size() - (above < limit ? 0u : 1u)) << above;
  }
}

TEST(Ptd, SteepPlanesAreGroundUpToTheirEdges) {
  core::Block b = grid(130, [](double x, double y) { return 100.0 + 0.8 * x - 0.6 * y; });
  classify_ground_ptd(b, b.size(), {});
  EXPECT_EQ(ground_of(b), b.size());
}

TEST(Ptd, MirroringKeepsTheUpperEdgeOfABreak) {
  const auto terrain = [](double x, double) { return x < 60.3 ? 100.0 : 112.0; };
  core::Block with = grid(121, terrain), without = with;
  PtdOptions o;
  o.building = core::Metres(10.0);  // so that facets over the break are steep
  classify_ground_ptd(with, with.size(), o);
  o.mirror = false;
  classify_ground_ptd(without, without.size(), o);
  const auto lost = [](const core::Block& b) { return b.size() - ground_of(b); };
  EXPECT_GT(lost(without), 121u);  // more than the edge itself
  EXPECT_LT(2 * lost(with), lost(without));
}

TEST(Ptd, ABuildingNarrowerThanTheSquaresIsNoGround) {
  const auto inside = [](double x, double y) { return std::abs(x - 80.0) < 19.0 && std::abs(y - 70.0) < 19.0; };
  core::Block b = grid(160, [&](double x, double y) { return 100.0 + (inside(x, y) ? 6.0 : 0.0); });
  classify_ground_ptd(b, b.size(), {});
  for (size_t p = 0; p < b.size(); ++p)
    EXPECT_EQ(b.classification[p] == core::point_class::ground, !inside(b.x[p], b.y[p])) << b.x[p] << " " << b.y[p];
}

TEST(Ptd, NoiseEarlyReturnsAndHaloKeepOut) { test::expect_only_own_last_returns_judged(run()); }

TEST(Ptd, SeamsBetweenPatchesDecideLittle) {
  PtdOptions o;
  o.building = core::Metres(15.0);
  constexpr double bearable = 1.0;  // %: the seeds change with the squares too
  for (const char* scene : {"slope", "town", "forest"}) EXPECT_LT(test::labels_that_hang_on_the_seams(scene, run(o)), bearable) << scene;
}

}  // namespace
}  // namespace swath::filters
