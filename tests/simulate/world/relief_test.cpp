// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/relief.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double half = 800.0;

TEST(Relief, GradientIsTheDerivativeOfTheHeight) {
  constexpr double step = 1e-3, tolerance = 1e-6;  // third derivatives are below 1 / m^2
  for (const Scene scene : {Scene::flat, Scene::hills, Scene::steep, Scene::mixed, Scene::zoo}) {
    const Relief relief({.scene = scene}, 3, core::degrees(60), half);
    Random random(1, 1, 1);
    for (int i = 0; i < 2000; ++i) {
      const double e = random.uniform(-half, half), n = random.uniform(-half, half);
      const Relief::Sample s = relief.at(e, n);
      bool shore = false;
      for (const double d : {-2 * step, 2 * step})
        shore = shore || relief.is_water(e + d, n) != s.water || relief.is_water(e, n + d) != s.water;
      if (shore) continue;
      EXPECT_NEAR(s.gradient.x(), (relief.height(e + step, n) - relief.height(e - step, n)) / (2 * step), tolerance);
      EXPECT_NEAR(s.gradient.y(), (relief.height(e, n + step) - relief.height(e, n - step)) / (2 * step), tolerance);
    }
  }
}

TEST(Relief, BoundsHold) {
  for (const Scene scene : {Scene::flat, Scene::hills, Scene::steep, Scene::mixed, Scene::forest, Scene::town, Scene::zoo}) {
    const Relief relief({.scene = scene}, 5, core::degrees(10), half);
    for (double e = -half; e <= half; e += 7.3)
      for (double n = -half; n <= half; n += 7.3) {
        const Relief::Sample s = relief.at(e, n);
        ASSERT_LE(s.gradient.norm(), relief.steepest() + 1e-12);
        ASSERT_LE(s.height, relief.highest());
        ASSERT_GE(s.height, relief.lowest());
      }
  }
}

TEST(Relief, ScenesHaveWhatTheirNamesSay) {
  const auto steepest_seen = [](const WorldOptions& w) {
    const Relief relief(w, 5, core::degrees(60), half);
    double steepest = 0;
    for (double e = -200; e <= 200; e += 1.7)
      for (double n = -200; n <= 200; n += 1.7) steepest = std::max(steepest, relief.at(e, n).gradient.norm());
    return steepest;
  };
  EXPECT_LT(steepest_seen({.scene = Scene::flat}), 0.011);
  EXPECT_GT(steepest_seen({.scene = Scene::steep}), 1.4);
  const Relief mixed({.scene = Scene::mixed}, 1, core::degrees(60), half);
  int water = 0;
  double level = 0;
  for (double e = -half; e <= half; e += 5)
    for (double n = -half; n <= half; n += 5)
      if (mixed.is_water(e, n)) {
        if (water++ == 0) level = mixed.height(e, n);
        EXPECT_EQ(mixed.height(e, n), level);
        EXPECT_EQ(mixed.at(e, n).gradient.norm(), 0.0);
      }
  EXPECT_GT(water, 40);
}

WorldOptions level() {
  WorldOptions w;
  w.scene = Scene::flat;
  w.slope = 0.0;
  return w;
}

TEST(Relief, ADitchIsAsDeepAsToldAndLevelBeyondItsHalfWidth) {
  WorldOptions w = level();
  EXPECT_FALSE(Relief(w, 1, core::degrees(60), half).ditch());
  w.ditch = core::Metres(5.0);
  const Relief relief(w, 1, core::degrees(60), half);
  ASSERT_TRUE(relief.ditch());
  const Relief::Ditch& ditch = *relief.ditch();
  const auto depth = [&](double from_middle) {
    const Eigen::Vector2d p = (ditch.offset + from_middle) * ditch.normal;
    return w.ground.value - relief.height(p.x(), p.y());
  };
  // The flanks' tails overlap: 4.4 m of 5 m are left in the middle, 2 % of it at the half width.
  EXPECT_GT(depth(0), 0.85 * 5.0);
  EXPECT_LE(depth(0), 5.0);
  EXPECT_LT(std::abs(depth(ditch.half_width)), 0.02 * 5.0);
  EXPECT_LT(std::abs(depth(-ditch.half_width)), 0.02 * 5.0);
}

TEST(Relief, ATerrainModelIsTheGround) {
  std::vector<float> z;
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 50; ++i) z.push_back(static_cast<float>(300 + 5 * std::sin(0.3 * i) + 0.5 * j));
  const core::HeightField field({5000, 7000, 10, 10, 50, 50}, z);
  const Relief relief(field, {5240, 7230});
  for (double d = -200; d <= 200; d += 7.3) {
    const Relief::Sample s = relief.at(d, -0.5 * d);
    EXPECT_EQ(s.height, field.height(5240 + d, 7230 - 0.5 * d));
    EXPECT_LE(s.gradient.norm(), relief.steepest());
    EXPECT_FALSE(s.water);
  }
  EXPECT_EQ(relief.highest(), field.highest());
  EXPECT_EQ(relief.lowest(), field.lowest());
  EXPECT_FALSE(relief.ditch());
}

TEST(Relief, AScarpHasItsSlope) {
  for (const double slope : {0.8, 1.43, 2.5}) {
    WorldOptions w = level();
    w.scarp = core::Metres(9.0);
    w.scarp_slope = slope;
    const Relief relief(w, 1, core::degrees(60), half);
    double steepest = 0;
    // Along a line across it; the step misses the steepest place by less than 1 cm of flanks wider than 1 m.
    for (double d = -400; d <= 400; d += 0.01) steepest = std::max(steepest, relief.at(0.7 * d, -0.7 * d).gradient.norm());
    EXPECT_NEAR(steepest, slope, 1e-3 * slope);
  }
}

}  // namespace
}  // namespace swath::simulate
