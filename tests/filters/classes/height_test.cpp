// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/height.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::filters {
namespace {

// Heights are float: 500 m is held to 3e-5 m. They are rounded to 1/1024 m, of which 1.5 m is a multiple.
constexpr float rounding = 1e-4f;

core::Grid plane() {
  core::Grid g(core::lattice_of(2.0, 100, 200, 120, 220));
  for (int j = 0; j < g.lattice.ny; ++j)
    for (int i = 0; i < g.lattice.nx; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(500 + 0.5 * g.lattice.centre_x(i) - 0.25 * g.lattice.centre_y(j));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  return g;
}

TEST(Height, IsExactOnAPlane) {
  core::Block b;
  b.origin = {100, 200, 0};
  for (const auto& [x, y] : {std::pair{5.3, 7.9}, {10.0, 10.0}, {3.01, 14.7}}) {
    b.x.push_back(x);
    b.y.push_back(y);
    b.z.push_back(500 + 0.5 * (100 + x) - 0.25 * (200 + y) + 1.5);
  }
  EXPECT_EQ(height_above(plane(), b, b.size()), 0u);
  for (const float h : b.height) EXPECT_NEAR(h, 1.5f, rounding);
}

TEST(Height, IsRoundedToTheStepsOfFiles) {
  core::Block b;
  b.origin = {100, 200, 0};
  b.x = b.y = {5.0, 6.0, 7.0};
  for (size_t i = 0; i < 3; ++i) b.z.push_back(500 + 0.5 * (100 + b.x[i]) - 0.25 * (200 + b.y[i]) + 1.2345);
  height_above(plane(), b, 3);
  for (const float h : b.height) {
    EXPECT_EQ(h * 1024.0f, std::round(h * 1024.0f));
    EXPECT_NEAR(h, 1.2345f, 0.5f / 1024.0f + rounding);
  }
}

TEST(Height, VoidsDropOutAndAreCounted) {
  core::Grid g = plane();
  for (auto& r : g.reason) r = core::Void::no_data;
  core::Block b;
  b.origin = {100, 200, 0};
  b.x = {5, 5};
  b.y = {5, 5};
  b.z = {510, 511};
  EXPECT_EQ(height_above(g, b, 1), 1u);
  EXPECT_TRUE(std::isnan(b.height[0]));
  g.reason[g.lattice.at(2, 2)] = core::Void::none;
  EXPECT_EQ(height_above(g, b, 2), 0u);
  EXPECT_NEAR(b.height[1] - b.height[0], 1.0f, rounding);
}

}  // namespace
}  // namespace swath::filters
