// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/check_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::calib {
namespace {

TEST(CheckPoints, HeightOfThePlaneAtThePoint) {
  const Eigen::Vector3d place(500100.3, 5300200.7, 612.0);
  CheckPoints checks({{"a", place, 0.01}, {"far", {0, 0, 0}, 0.01}}, 2.0);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (int batch = 0; batch < 2; ++batch) {
    core::Block b;
    b.origin = {500000, 5300000, 600};
    for (int i = -20; i < 20; ++i)
      for (int j = -20; j < 20; ++j) {
        const double x = 0.31 * i, y = 0.29 * j + 0.1 * batch;
        b.x.push_back(place.x() - b.origin.x() + x);
        b.y.push_back(place.y() - b.origin.y() + y);
        b.z.push_back(12.05 + 0.3 * x - 0.2 * y + noise(random));
      }
    // Second returns would pull the plane down.
    b.return_number.assign(b.size(), 1);
    b.return_count.assign(b.size(), 1);
    core::Block low = b;
    for (double& z : low.z) z -= 3;
    low.return_number.assign(low.size(), 2);
    low.return_count.assign(low.size(), 2);
    core::append(b, low);
    checks.add(b);
  }
  const auto found = checks.residuals();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GT(found[0].returns, 200u);
  constexpr double of_the_mean = 0.02 / 14;  // 200 returns and more
  EXPECT_NEAR(found[0].difference, 0.05, 4 * of_the_mean);
  EXPECT_NEAR(found[0].roughness, 0.02, 0.003);
  EXPECT_GT(found[0].sigma, 0.01);
  EXPECT_LT(found[0].sigma, 0.0105);
  EXPECT_TRUE(std::isnan(found[1].difference));
  EXPECT_EQ(found[1].returns, 0u);
}

TEST(CheckPoints, ReturnsInOneRowMakeNoPlane) {
  CheckPoints checks({{"row", {0, 0, 0}, 0.01}}, 2.0);
  core::Block b;
  for (int i = -20; i <= 20; ++i) {
    b.x.push_back(0.1 * i);
    b.y.push_back(0.001 * i);
    b.z.push_back(0);
  }
  checks.add(b);
  EXPECT_TRUE(std::isnan(checks.residuals()[0].difference));
}

}  // namespace
}  // namespace swath::calib
