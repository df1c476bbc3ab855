// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/sight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace swath::calib {
namespace {

using Eigen::Vector3d;

/// Ground and the roof of a house, points half a metre apart, 1000 m from the block's origin.
core::Block village(double roof) {
  core::Block b;
  b.origin = {1000, 2000, 300};
  for (double x = -50; x < 50; x += 0.45)
    for (double y = -50; y < 50; y += 0.45) {
      const bool house = x > -10 && x < 10 && y > -10 && y < 10;
      b.x.push_back(x), b.y.push_back(y), b.z.push_back(house ? roof : 0.0);
    }
  b.classification.assign(b.size(), core::point_class::unassigned);
  b.flags.assign(b.size(), 0);
  return b;
}

const Vector3d origin(1000, 2000, 300);

TEST(Sight, TopsOfPointsInTheirCells) {
  core::Block b;
  b.origin = {10, 20, 100};
  b.x = {0.1, 0.2, 3.9}, b.y = {0.1, 0.2, 0.1}, b.z = {1, 2, -5};
  const core::Grid tops = tops_of(b, 0.5);
  EXPECT_EQ(tops.lattice, (core::Lattice{0.5, 20, 40, 8, 1}));
  EXPECT_EQ(tops.height[0], 102.0f);
  EXPECT_TRUE(std::isnan(tops.height[1]));
  EXPECT_EQ(tops.height[7], 95.0f);
}

TEST(Sight, ARoofHidesWhatLiesBehindItAndUnderIt) {
  const core::Grid tops = tops_of(village(15.0), 0.5);
  const Sight sight(tops, 30.0);
  const Vector3d camera = origin + Vector3d(100, 0, 100);  // rays come down at 45 degrees from the east
  const auto hidden = [&](double x, double z) { return sight.is_hidden(origin + Vector3d(x, 0.2, z), camera, 1.0); };
  EXPECT_FALSE(hidden(20.0, 0.0));                                                                      // in front
  EXPECT_FALSE(hidden(0.0, 15.0));                                                                      // on the roof
  EXPECT_TRUE(hidden(-12.0, 0.0));                                                                      // behind
  EXPECT_TRUE(hidden(0.0, 0.0));                                                                        // inside
  EXPECT_FALSE(hidden(10.0, 7.0));                                                                      // on the wall to the camera
  EXPECT_TRUE(hidden(-10.0, 7.0));                                                                      // on the other one
  EXPECT_FALSE(hidden(-40.0, 0.0));                                                                     // beyond the shade
  EXPECT_FALSE(hidden(-12.0, 20.0));                                                                    // above it all
  EXPECT_FALSE(sight.is_hidden(origin + Vector3d(0, 0.2, 5), origin + Vector3d(100, 0, 4), 1.0));       // a camera below
  EXPECT_TRUE(sight.is_hidden(origin + Vector3d(3.1, 3.2, 0), origin + Vector3d(3.1, 3.2, 500), 1.0));  // straight down
  EXPECT_FALSE(sight.is_hidden(origin + Vector3d(13.1, 3.2, 0), origin + Vector3d(13.1, 3.2, 500), 1.0));
}

TEST(Sight, LevelGroundDoesNotHideItselfHoweverObliqueTheRay) {
  core::Block b = village(0.0);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> rough(0.0, 0.3);
  for (double& z : b.z) z += rough(random);
  const core::Grid tops = tops_of(b, 0.5);
  const Sight sight(tops, 30.0);
  for (size_t i = 0; i < b.size(); i += 7) {
    const Vector3d place = origin + Vector3d(b.x[i], b.y[i], b.z[i]);
    EXPECT_FALSE(sight.is_hidden(place, place + Vector3d(500, 300, 120), 1.0));
  }
}

TEST(Sight, NothingBeyondTheReachHides) {
  const core::Grid tops = tops_of(village(15.0), 0.5);
  const Vector3d place = origin + Vector3d(-45, 0, 0), camera = origin + Vector3d(900, 0, 240);  // 14 degrees above the horizon
  EXPECT_TRUE(Sight(tops, 60.0).is_hidden(place, camera, 1.0));
  EXPECT_FALSE(Sight(tops, 30.0).is_hidden(place, camera, 1.0));
}

TEST(Sight, NoiseAndWiresHideNothing) {
  core::Block b = village(15.0);
  for (size_t i = 0; i < b.size(); ++i)
    if (b.z[i] > 0) b.classification[i] = i % 2 ? core::point_class::wire : core::point_class::high_noise;
  const core::Grid tops = tops_of(b, 0.5), none = tops_of(core::Block{}, 0.5);
  EXPECT_FALSE(Sight(tops, 30.0).is_hidden(origin + Vector3d(3, 3, 0), origin + Vector3d(3, 3, 500), 1.0));
  EXPECT_FALSE(Sight(none, 30.0).is_hidden({0, 0, 0}, {0, 0, 500}, 1.0));
}

TEST(Sight, WhatIsHiddenDoesNotDependOnWhereATileEnds) {
  const core::Block whole = village(15.0);
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < whole.size(); ++i)
    if (whole.x[i] < 20 && whole.x[i] > -36 && whole.y[i] > -36 && whole.y[i] < 36) rows.push_back(i);
  const core::Grid all = tops_of(whole, 0.5), part = tops_of(core::select(whole, rows), 0.5);
  const Sight a(all, 25.0), b(part, 25.0);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  int hidden = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3d place = origin + Vector3d(-8.0 + 2.0 * in(random), 10.0 * in(random), 14.0 + 3.0 * in(random));
    const Vector3d camera = origin + Vector3d(400 * in(random), 400 * in(random), 60);
    hidden += a.is_hidden(place, camera, 0.5);
    EXPECT_EQ(a.is_hidden(place, camera, 0.5), b.is_hidden(place, camera, 0.5));
  }
  EXPECT_GT(hidden, 500);
  EXPECT_LT(hidden, 4500);
}

/// Every column on the way looked at in small steps, as a second opinion.
TEST(Sight, AgreesWithARayInSmallSteps) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> in(0.0, 1.0);
  constexpr double cell = 0.7, reach = 9.0, clearance = 0.5;
  core::Grid tops({cell, 0, 0, 30, 30});
  for (float& h : tops.height) h = static_cast<float>(8.0 * std::pow(in(random), 6.0));
  const Sight sight(tops, reach);
  int hidden = 0, other = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vector3d place(20 * in(random), 20 * in(random), 6 * in(random)), camera(60 * in(random)-20, 60 * in(random)-20, 25);
    const Vector3d way = (camera - place).normalized();
    bool found = false;
    for (double s = clearance / way.z(); !found && s * way.head<2>().norm() <= reach && s < 60; s += 0.002) {
      const Vector3d p = place + s * way;
      const auto i = static_cast<int>(std::floor(p.x() / cell)), j = static_cast<int>(std::floor(p.y() / cell));
      found = tops.lattice.holds(i, j) && static_cast<double>(tops.height[tops.lattice.at(i, j)]) > p.z();
    }
    hidden += found;
    other += found != sight.is_hidden(place, camera, clearance);
  }
  EXPECT_GT(hidden, 150);
  EXPECT_LT(hidden, 900);
  EXPECT_LE(other, 3);  // corners that a step passes over
}

core::Grid ridge() {
  core::Grid g({1.0, 0, 0, 80, 20});
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 80; ++i) g.height[g.lattice.at(i, j)] = i >= 40 && i < 44 ? 20.0f : 5.0f;
  g.height[g.lattice.at(60, 10)] = std::numeric_limits<float>::quiet_NaN();
  return g;
}

TEST(Sight, ARidgeHidesTheGroundBehindIt) {
  const core::Grid grid = ridge();
  const Sight sight(grid, 100.0);
  const Vector3d east(160.5, 10.5, 105.0);
  EXPECT_TRUE(sight.is_hidden({30.5, 10.5, 5.0}, east, 1.0));
  EXPECT_FALSE(sight.is_hidden({10.5, 10.5, 5.0}, east, 1.0));
  EXPECT_FALSE(sight.is_hidden({50.5, 10.5, 5.0}, east, 1.0));
  EXPECT_FALSE(sight.is_hidden({41.5, 10.5, 20.0}, east, 1.0));
  EXPECT_FALSE(sight.is_hidden({30.5, 10.5, 5.0}, {30.5, 10.5, 500.0}, 1.0));  // from above
  EXPECT_FALSE(sight.is_hidden({30.5, 10.5, 5.0}, east, 30.0));
  EXPECT_FALSE(Sight(grid, 5.0).is_hidden({30.5, 10.5, 5.0}, east, 1.0));
}

}  // namespace
}  // namespace swath::calib
