// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/robust.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

auto run(const RobustOptions& o = {}) {
  return [o](core::Block& b, size_t own) { return classify_ground_robust(b, own, o); };
}

TEST(Robust, MadeScenesComeOutNearlyWhole) {
  // Scarp: the coarse levels round it off by metres.
  test::expect_within({{"flat", 0.1, 0},
                       {"slope", 0.1, 0},
                       {"town", 0.5, 0.5},
                       {"forest", 1.0, 0.5},
                       {"water", 0.1, 0},
                       {"void", 0.1, 0},
                       {"strip_edge", 0.1, 0}},
                      run());
}

TEST(Robust, TheToleranceIsAHeightOverTheGround) {
  for (const double above : {0.3, 0.9}) {
    test::Scene s = test::make_scene("slope");
    std::vector<size_t> raised;
    for (size_t p = 50; p < s.block.size(); p += 211) raised.push_back(p), s.block.z[p] = s.terrain(s.block.x[p], s.block.y[p]) + above;
    classify_ground_robust(s.block, s.block.size(), {});
    for (const size_t p : raised) EXPECT_EQ(s.block.classification[p] == core::point_class::ground, above < 0.5) << above;
  }
}

TEST(Robust, ABuildingNarrowerThanTheWidestCellIsNoGround) {
  test::Scene s = test::make_scene("flat");
  for (size_t p = 0; p < s.block.size(); ++p)
    if (std::abs(s.block.x[p] - 100.0) < 12.0 && std::abs(s.block.y[p] - 80.0) < 12.0) {
      s.block.z[p] += 6.0;
      s.truth[p] = core::point_class::building;
    }
  classify_ground_robust(s.block, s.block.size(), {});
  EXPECT_EQ(test::ground_errors(s.block, s.truth).type_2(), 0.0);
  EXPECT_LT(test::ground_errors(s.block, s.truth).type_1(), 0.5);  // %
}

TEST(Robust, NoiseEarlyReturnsAndHaloKeepOut) { test::expect_only_own_last_returns_judged(run()); }

TEST(Robust, SeamsBetweenUnitsDecideLittle) {
  constexpr double bearable = 0.5;  // %: the cells' lowest points change too
  for (const char* scene : {"slope", "town", "forest"}) EXPECT_LT(test::labels_that_hang_on_the_seams(scene, run()), bearable) << scene;
}

}  // namespace
}  // namespace swath::filters
