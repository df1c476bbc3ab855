// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/relief.h"

#include <gtest/gtest.h>

#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double half = 800.0;

TEST(Relief, GradientIsTheDerivativeOfTheHeight) {
  constexpr double step = 1e-3, tolerance = 1e-6;  // third derivatives are below 1 / m^2
  for (const Scene scene : {Scene::flat, Scene::hills, Scene::steep, Scene::mixed}) {
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
  for (const Scene scene : {Scene::flat, Scene::hills, Scene::steep, Scene::mixed, Scene::forest, Scene::town}) {
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

}  // namespace
}  // namespace swath::simulate
