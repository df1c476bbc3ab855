// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::planning {
namespace {

using Eigen::Vector2d;

TEST(Turn, RadiusOfALevelTurn) { EXPECT_NEAR(turn_radius(60, std::atan(1 / 9.80665)), 3600, 1e-6); }

TEST(Turn, StraightOnIsTheDistance) {
  EXPECT_NEAR(turn_length({0, 0}, 0.0, {0, 500}, 0.0, 100), 500, 1e-6);
  EXPECT_NEAR(turn_length({10, 20}, 0.6, {10 + 900 * std::sin(0.6), 20 + 900 * std::cos(0.6)}, 0.6, 250), 900, 1e-6);
}

/// Onto a line beside, flown back: half a circle and the straight rest, or a bulb where the lines lie closer than a turn is wide.
TEST(Turn, OntoTheNextLine) {
  const double r = 400;
  EXPECT_NEAR(turn_length({0, 0}, 0.0, {1000, 0}, M_PI, r), M_PI * r + 200, 1e-6);
  EXPECT_NEAR(turn_length({0, 0}, 0.0, {-1000, 0}, M_PI, r), M_PI * r + 200, 1e-6);
  const double d = 300;
  EXPECT_NEAR(turn_length({0, 0}, 0.0, {d, 0}, M_PI, r), r * (3 * M_PI - 4 * std::asin((2 * r + d) / (4 * r))), 1e-6);
}

TEST(Turn, AQuarter) { EXPECT_NEAR(turn_length({0, 0}, 0.0, {200, 200}, M_PI / 2, 200), M_PI / 2 * 200, 1e-6); }

/// The way back is as long, no way is shorter than the distance, and turning the map changes nothing.
TEST(Turn, AnyTwoPlaces) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3000, 3000), course(0, 2 * M_PI);
  for (int k = 0; k < 300; ++k) {
    const Vector2d a(place(random), place(random)), b(place(random), place(random));
    const double ca = course(random), cb = course(random), by = course(random);
    const double length = turn_length(a, ca, b, cb, 500);
    EXPECT_GE(length, (b - a).norm() - 1e-6);
    EXPECT_LT(length, (b - a).norm() + 4 * M_PI * 500);
    EXPECT_NEAR(turn_length(b, cb + M_PI, a, ca + M_PI, 500), length, 1e-6);
    const auto turned = [&](const Vector2d& p) {
      return Vector2d(std::cos(by) * p.x() + std::sin(by) * p.y(), -std::sin(by) * p.x() + std::cos(by) * p.y());
    };
    EXPECT_NEAR(turn_length(turned(a), ca + by, turned(b), cb + by, 500), length, 1e-6);
  }
}

}  // namespace
}  // namespace swath::planning
