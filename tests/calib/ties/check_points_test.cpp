// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/check_points.h"

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

TEST(CheckPoints, PointsAndPlanesOfUseCheck) {
  const auto plane = [](const char* name, io::ControlUse use, double rise, double half) {
    SurveyedTarget t;
    t.name = name;
    t.use = use;
    t.normal = Eigen::Vector3d(-rise, 0, 1).normalized();
    t.centre = {50, 20, 8};
    for (const auto& [x, y] : {std::pair{1, 1}, std::pair{-1, 1}, std::pair{-1, -1}, std::pair{1, -1}}) {
      t.corners.push_back(t.centre + half * Eigen::Vector3d(x, y, x * rise));
      t.control.push_back({t.corners.back(), 0.02, name});
    }
    return t;
  };
  SurveyedTarget peg;
  peg.name = "peg";
  peg.is_point = true;
  peg.use = io::ControlUse::check;
  peg.centre = {1, 2, 3};
  peg.control = {{peg.centre, 0.03, "peg"}};
  const Eigen::Vector3d away(500000, 5300000, 600);
  const auto found = check_points_of({plane("control", io::ControlUse::control, 0.5, 5), plane("roof", io::ControlUse::check, 0.5, 5), peg,
                                      plane("small", io::ControlUse::check, 0.0, 1.5), plane("wall", io::ControlUse::check, 5.0, 5)},
                                     [&](const Eigen::Vector3d& local) -> Eigen::Vector3d { return local + away; });
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].name, "roof");
  EXPECT_EQ(found[0].map, away + Eigen::Vector3d(50, 20, 8));
  EXPECT_NEAR(found[0].sigma, 0.01 * std::hypot(0.5, 1.0), 1e-12);  // of the mean of four along the normal, as a height
  EXPECT_DOUBLE_EQ(found[0].radius, 2.0);
  EXPECT_EQ(found[1].name, "peg");
  EXPECT_EQ(found[1].sigma, 0.03);
  EXPECT_EQ(found[1].radius, 0.0);
  EXPECT_NEAR(found[2].radius, 1.0, 1e-12);  // half a metre within its edges
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
