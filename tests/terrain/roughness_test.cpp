// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/roughness.h"

#include <gtest/gtest.h>

#include <random>

#include "terrain/tin/tin_surface.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr double side = 10.0;
const core::Lattice window{1.0, 500030, 4600030, 40, 40};

Roughness in_the_middle(const core::Block& b) {
  const Tin tin = triangulate(b, test::all_rows(b), 10.0);
  return RoughnessMap(tin, b.origin, window, side).at(50.0, 50.0);
}

core::Block with_noise(const test::Surface& surface, double sigma, size_t n = 20000) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, sigma);
  return test::random_points(
      n, 100.0, [&](double x, double y) { return surface(x, y) + noise(random); }, 8);
}

TEST(Roughness, NoiseOfThePointsIsTold) {
  const Roughness r = in_the_middle(with_noise([](double x, double y) { return 0.3 * x - 0.2 * y; }, 0.05));
  ASSERT_TRUE(r.known);
  EXPECT_NEAR(std::sqrt(r.noise), 0.05, 0.006);
}

TEST(Roughness, ErrorsBetweenThePointsAreForetold) {
  // Waves of all directions and two lengths: the misfit at random places against what the map expects there.
  const auto waves = [](double x, double y) {
    double z = 0.0;
    for (int k = 0; k < 12; ++k) {
      const double angle = 0.55 * k, wave = 2.0 * M_PI / (k % 2 ? 25.0 : 40.0);
      z += 0.3 * std::sin(wave * (x * std::cos(angle) + y * std::sin(angle)) + 1.7 * k);
    }
    return z;
  };
  for (const size_t n : {size_t{800}, size_t{3000}, size_t{12000}}) {
    double expected = 0.0, found = 0.0;
    for (unsigned draw = 0; draw < 10; ++draw) {
      const core::Block b = test::random_points(n, 100.0, waves, 50 + draw);
      const Tin tin = triangulate(b, test::all_rows(b), 20.0);
      const RoughnessMap map(tin, b.origin, window, side);
      std::vector<double> x, y;
      for (int k = 0; k < 1000; ++k) x.push_back(30.5 + std::fmod(7.31 * k, 39.0)), y.push_back(30.5 + std::fmod(3.77 * k, 39.0));
      const auto at = triangles_at(tin, x, y);
      for (size_t k = 0; k < x.size(); ++k) {
        const Roughness r = map.at(x[k], y[k]);
        const auto w = weights(tin, at[k], x[k], y[k]);
        const double s = reach_of(tin, at[k], w, x[k], y[k]);
        expected += r.noise * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) + r.uneven * s + 0.25 * r.curved * s * s;
        found += std::pow(height_in(tin, at[k], x[k], y[k]) - waves(x[k], y[k]), 2);
      }
    }
    EXPECT_NEAR(std::sqrt(found / expected), 1.0, 0.2) << n;
  }
}

TEST(Roughness, BothAreToldApart) {
  constexpr double curvature = 0.05, sigma = 0.03;
  const Roughness r = in_the_middle(with_noise([](double x, double y) { return 0.5 * curvature * (x * x + y * y); }, sigma, 6000));
  EXPECT_NEAR(std::sqrt(r.noise), sigma, 0.3 * sigma);
}

TEST(Roughness, TooFewPointsTellNothing) {
  const core::Block b = test::random_points(
      6, 100.0, [](double, double) { return 0.0; }, 8);
  EXPECT_FALSE(in_the_middle(b).known);
}

}  // namespace
}  // namespace swath::terrain
