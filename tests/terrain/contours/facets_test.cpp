// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/facets.h"

#include <gtest/gtest.h>

#include "tests/terrain/lines.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr double float_rounding = 1e-5;  // of heights of some 50 m

double hills(double x, double y) { return 50.0 + 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0); }

TEST(Facets, APlaneIsItselfEverywhere) {
  const auto plane = [](double x, double y) { return 10.0 + 0.3 * x - 0.2 * y; };
  const core::Grid g = test::sampled({0.5, -300, -280, 600, 560}, plane);  // several pages, on both sides of zero
  Facets f = test::facets_of(g);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-149, 149), y(-139, 139);
  for (int k = 0; k < 2000; ++k) {
    const double px = x(random), py = y(random);
    ASSERT_NEAR(f.at(px, py), plane(px, py), float_rounding);
  }
}

TEST(Facets, DepartsFromTheBilinearSurfaceByASixteenthOfTheTwist) {
  core::Grid g = test::sampled({1.0, 0, 0, 2, 2}, [](double, double) { return 0.0; });
  g.height = {1.0f, 0.0f, 0.0f, 1.0f};  // twist 2
  Facets f = test::facets_of(g);
  double most = 0.0;
  for (double v = 0.0; v < 1.0; v += 0.01)
    for (double u = 0.0; u < 1.0; u += 0.01) {
      const double bilinear = (1 - u) * (1 - v) + u * v;
      most = std::max(most, std::abs(f.at(0.5 + u, 0.5 + v) - bilinear));
    }
  EXPECT_NEAR(most, 2.0 / 16.0, 1e-3);
}

TEST(Facets, ASegmentIsWithinExactlyWhereAllOfItIs) {
  const core::Grid g = test::sampled({1.0, 100, 200, 80, 80}, hills);
  Facets f = test::facets_of(g);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(102.0, 178.0), step(-6.0, 6.0);
  int within = 0, beyond = 0;
  for (int n = 0; n < 3000; ++n) {
    const Eigen::Vector2d a(place(random), place(random) + 100.0), b = a + Eigen::Vector2d(step(random), step(random));
    if (b.x() < 102 || b.x() > 178 || b.y() < 202 || b.y() > 278) continue;
    const double height = f.at(a.x(), a.y());
    double most = 0.0;
    constexpr int steps = 400;
    for (int s = 0; s <= steps; ++s) {
      const Eigen::Vector2d p = a + (b - a) * (static_cast<double>(s) / steps);
      most = std::max(most, std::abs(f.at(p.x(), p.y()) - height));
    }
    // The steps come within 1/400 of the segment of its true extreme; slopes are below 0.9.
    const double slack = 0.9 * (b - a).norm() / steps;
    EXPECT_TRUE(f.within(a, b, height, most + slack));
    EXPECT_FALSE(f.within(a, b, height, most - 1e-9));
    ++(f.within(a, b, height, 0.5) ? within : beyond);
  }
  EXPECT_GT(within, 100);
  EXPECT_GT(beyond, 100);
}

TEST(Facets, VoidsAreOnNoSegmentAndInNoTriangle) {
  core::Grid g = test::sampled({1.0, 0, 0, 20, 20}, [](double, double) { return 5.0; });
  g.height[g.lattice.at(10, 10)] = std::nanf("");
  Facets f = test::facets_of(g);
  EXPECT_TRUE(f.within({2.0, 2.0}, {18.0, 3.0}, 5.0, 0.1));
  EXPECT_FALSE(f.within({2.0, 10.1}, {18.0, 10.2}, 5.0, 0.1));
  EXPECT_FALSE(f.within({10.2, 2.0}, {10.3, 18.0}, 5.0, 0.1));
  EXPECT_TRUE(f.within_inside({2.0, 2.0}, {8.0, 2.0}, {2.0, 8.0}, 5.0, 0.1));
  EXPECT_FALSE(f.within_inside({2.0, 2.0}, {18.0, 10.0}, {10.0, 18.0}, 5.0, 0.1));
  EXPECT_TRUE(std::isnan(f.at(25.0, 5.0)));
}

}  // namespace
}  // namespace swath::terrain
