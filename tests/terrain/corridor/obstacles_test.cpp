// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/obstacles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::terrain {
namespace {

TEST(Obstacles, TheGroundIsAPlaneWithATrueSigma) {
  double squares = 0.0, n = 0.0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0.0, 20.0);
    std::normal_distribution<double> noise(0.0, 0.03);
    std::vector<Obstacle> all;
    for (int k = 0; k < 1200; ++k) {
      const double x = place(random), y = place(random);
      all.push_back({x, y, 100.0 + 0.2 * x - 0.1 * y + noise(random), Hazard::ground});
      if (k % 3 == 0) all.push_back({x, y, 105.0, Hazard::vegetation});
    }
    const auto g = Obstacles(all).ground({9.0, 11.0});
    ASSERT_TRUE(g);
    squares += std::pow((g->z - 100.7) / g->sigma, 2), ++n;
  }
  EXPECT_NEAR(std::sqrt(squares / n), 1.0, 0.15);  // 3 sigmas of 200 rounds
}

TEST(Obstacles, TheCircleGrowsWhereReturnsAreFewAndEnds) {
  std::vector<Obstacle> all;
  for (int k = 0; k < 12; ++k) all.push_back({3.0 * std::cos(k), 3.0 * std::sin(k), 50.0, Hazard::ground});
  const Obstacles obstacles(all);
  ASSERT_TRUE(obstacles.ground({0.0, 0.0}));
  EXPECT_NEAR(obstacles.ground({0.0, 0.0})->z, 50.0, 1e-9);
  EXPECT_FALSE(obstacles.ground({40.0, 0.0}));
  int seen = 0;
  obstacles.in_box(-4.0, -4.0, 4.0, 4.0, [&](const Obstacle&) { ++seen; });
  EXPECT_EQ(seen, 12);
}

}  // namespace
}  // namespace swath::terrain
