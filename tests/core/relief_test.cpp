// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace swath::core {
namespace {

constexpr double float_step = 2e-4;  // deg: heights of 100 m in floats, over 8 cells

Grid sampled(const Lattice& l, const std::function<double(double, double)>& height) {
  Grid g(l);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      g.height[l.at(i, j)] = static_cast<float>(height(l.centre_x(i), l.centre_y(j)));
      g.reason[l.at(i, j)] = Void::none;
    }
  return g;
}

const Lattice wide{2.0, -1, -1, 22, 22}, own{2.0, 0, 0, 20, 20};

TEST(Relief, SlopeOfAPlane) {
  const Grid g = slope(sampled(wide, [](double x, double y) { return 0.3 * x - 0.4 * y; }), own);
  for (const float s : g.height) EXPECT_NEAR(static_cast<double>(s), std::atan(0.5) * 180.0 / M_PI, float_step);
}

TEST(Relief, LightByLambert) {
  Light o;
  const auto plane = [](double e, double n) { return sampled(wide, [=](double x, double y) { return e * x + n * y; }); };
  EXPECT_NEAR(static_cast<double>(hillshade(plane(0, 0), own, o).height[0]), 255.0 * std::sqrt(0.5), 1e-3);
  // A slope of 45 degrees that falls to the north-west faces the light; the other way it is in shade.
  const double c = std::sqrt(0.5);
  EXPECT_NEAR(static_cast<double>(hillshade(plane(c, -c), own, o).height[7]), 255.0, 1e-2);
  EXPECT_NEAR(static_cast<double>(hillshade(plane(-c, c), own, o).height[7]), 0.0, 1e-2);
}

TEST(Relief, FourLightsLeaveNoSlopeDark) {
  Light o;
  o.multidirectional = true;
  const auto light = [&](double e, double n) {
    return static_cast<double>(hillshade(sampled(wide, [=](double x, double y) { return e * x + n * y; }), own, o).height[7]) / 255.0;
  };
  constexpr double float_light = 1e-5;
  EXPECT_NEAR(light(0, 0), std::sqrt(0.5), float_light);
  EXPECT_NEAR(light(0.001, 0), std::sqrt(0.5), 1e-3) << "nearly level ground is as light as level ground";
  EXPECT_GT(light(-1, 1), 0.2) << "falling away from 315 deg";
  // Falling to the west with slope 1; weights sin^2 of 45, 0, 45, 90 deg times cosines.
  const double c = std::sqrt(0.5), n = std::sqrt(2.0), side = (c + c * c) / n, north = c / n;
  EXPECT_NEAR(light(1, 0), (0.5 * side + 0.5 * side + north) / 2.0, float_light);
}

TEST(Relief, VoidsAndTheirNeighbours) {
  Grid model = sampled(wide, [](double x, double y) { return 0.3 * x - 0.4 * y; });
  const size_t hole = wide.at(11, 11);
  model.height[hole] = std::nanf("");
  model.reason[hole] = Void::long_edge;
  const Grid g = slope(model, own);
  EXPECT_EQ(g.reason[own.at(10, 10)], Void::long_edge);
  EXPECT_TRUE(std::isnan(g.height[own.at(10, 10)]));
  EXPECT_NEAR(static_cast<double>(g.height[own.at(9, 10)]), std::atan(0.5) * 180.0 / M_PI, float_step);
}

}  // namespace
}  // namespace swath::core
