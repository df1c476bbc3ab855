// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/relief.h"

#include <gtest/gtest.h>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr double float_step = 2e-4;  // deg: heights of 100 m in floats, over 8 cells

const core::Lattice wide{2.0, -1, -1, 22, 22}, own{2.0, 0, 0, 20, 20};

TEST(Relief, SlopeOfAPlane) {
  const core::Grid g = slope(test::sampled(wide, [](double x, double y) { return 0.3 * x - 0.4 * y; }), own);
  for (const float s : g.height) EXPECT_NEAR(static_cast<double>(s), std::atan(0.5) * 180.0 / M_PI, float_step);
}

TEST(Relief, LightByLambert) {
  ReliefOptions o;
  const auto plane = [](double e, double n) { return test::sampled(wide, [=](double x, double y) { return e * x + n * y; }); };
  EXPECT_NEAR(static_cast<double>(hillshade(plane(0, 0), own, o).height[0]), 255.0 * std::sqrt(0.5), 1e-3);
  // A slope of 45 degrees that falls to the north-west faces the light; the other way it is in shade.
  const double c = std::sqrt(0.5);
  EXPECT_NEAR(static_cast<double>(hillshade(plane(c, -c), own, o).height[7]), 255.0, 1e-2);
  EXPECT_NEAR(static_cast<double>(hillshade(plane(-c, c), own, o).height[7]), 0.0, 1e-2);
}

TEST(Relief, VoidsAndTheirNeighbours) {
  core::Grid model = test::sampled(wide, [](double x, double y) { return 0.3 * x - 0.4 * y; });
  const size_t hole = wide.at(11, 11);
  model.height[hole] = std::nanf("");
  model.reason[hole] = core::Void::long_edge;
  const core::Grid g = slope(model, own);
  EXPECT_EQ(g.reason[own.at(10, 10)], core::Void::long_edge);
  EXPECT_TRUE(std::isnan(g.height[own.at(10, 10)]));
  EXPECT_NEAR(static_cast<double>(g.height[own.at(9, 10)]), std::atan(0.5) * 180.0 / M_PI, float_step);
}

}  // namespace
}  // namespace swath::terrain
