// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/strand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace swath::terrain {
namespace {

TEST(Strand, LineAndCurveAreThoseOfTheReturnsWithoutTheGrossErrors) {
  const PlanLine truth{{100.0, 50.0}, {0.6, 0.8}};
  double turn = 0.0, n = 0.0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 0.05);
    std::vector<WirePoint> points;
    std::vector<std::uint32_t> rows;
    for (double s = -40.0; s <= 40.0; s += 0.5) {
      const Eigen::Vector2d p = truth.at(s, noise(random));
      points.push_back({p.x(), p.y(), 20.0 + s * s / 1200.0 + 0.4 * noise(random), 1});
      rows.push_back(static_cast<std::uint32_t>(rows.size()));
    }
    points[50].x += 1.0;
    points[90].z += 1.0;
    const Strand s = fit_strand(points, rows);
    ASSERT_TRUE(s.fit.found);
    for (const std::uint32_t gross : {50u, 90u}) EXPECT_EQ(std::count(s.points.begin(), s.points.end(), gross), 0);
    EXPECT_GE(s.points.size() + 6, points.size());  // 1 of 2000 good ones lies beyond 3.5 sigmas
    EXPECT_NEAR(s.length(), 80.0, 0.1);
    EXPECT_NEAR(1.0 / s.fit.curve.kappa, 600.0, 30.0);
    EXPECT_NEAR(s.at(s.line.s(truth.at(10.0))).z(), 20.083, 0.03);
    const double angle = std::asin(s.line.along.x() * truth.along.y() - s.line.along.y() * truth.along.x());
    turn += std::pow(angle / s.sigma_turn, 2), ++n;
  }
  EXPECT_NEAR(std::sqrt(turn / n), 1.0, 0.22);  // 3 sigmas of 100 rounds
}

TEST(Strand, TooFewReturnsHaveNoCurve) {
  EXPECT_FALSE(fit_strand({}, {}).fit.found);
  EXPECT_FALSE(fit_strand({{0, 0, 5, 1}, {1, 0, 5, 1}, {2, 0, 5, 1}}, {0, 1, 2}).fit.found);
}

}  // namespace
}  // namespace swath::terrain
