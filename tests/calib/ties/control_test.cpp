// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/control.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/error.h"
#include "core/geo/geodesy.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double rounding = 1e-8;  // m: ecef coordinates have their last place at 1e-9 m
constexpr const char* off_plane = "surveyed targets whose corners lie off one plane by more than four sigmas";

std::string examples_of(const core::Tally& tally) {
  std::string out;
  const core::Value all = tally.value();
  for (const core::Value& v : all.find(off_plane)->find("examples")->items()) out += v.as_text() + "\n";
  return out;
}

class ControlTargets : public ::testing::Test {
 protected:
  const trajectory::LocalFrame frame_ = trajectory::local_frame(core::ecef_of({0.8, 0.15, 400}));
  core::Tally tally_;

  io::ControlPoint point(const std::string& name, const std::string& target, const Vector3d& local) const {
    return {name, target, frame_.to_ecef(local), 0.01, 0.02, io::ControlUse::control, "c.csv:" + name};
  }
};

TEST_F(ControlTargets, SigmaAlongADirection) {
  EXPECT_DOUBLE_EQ(sigma_along(Vector3d::UnitZ(), 3, 4), 4);
  EXPECT_DOUBLE_EQ(sigma_along(Vector3d::UnitX(), 3, 4), 3);
  EXPECT_DOUBLE_EQ(sigma_along(Vector3d(0, 0.6, -0.8), 3, 4), std::hypot(1.8, 3.2));
}

TEST_F(ControlTargets, WhatLiesFarAwayIsLeftOutAndCounted) {
  const std::vector<io::ControlPoint> points{point("1", "", {0, 0, 10}),    point("2", "", {0, 0, 1e6}),  point("3", "r", {0, 0, 10}),
                                             point("4", "r", {2e6, 0, 10}), point("5", "r", {0, 30, 10}), point("6", "", {9e4, 0, 10})};
  const auto targets = surveyed_targets(points, frame_, tally_);
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_EQ(targets[1].name, "6");
  EXPECT_EQ(tally_.of("surveyed targets and points over 500 km from the survey, left out"), 2u);
  EXPECT_THROW(surveyed_targets({points[1]}, frame_, tally_), core::Error);  // all of them
}

TEST_F(ControlTargets, PlanesAndPoints) {
  // A roof that falls to the south by 1 in 2, a wall and two points.
  std::vector<io::ControlPoint> points{point("1", "roof", {0, 0, 10}),  point("2", "roof", {30, 0, 10}), point("3", "roof", {30, 10, 15}),
                                       point("4", "roof", {0, 10, 15}), point("5", "wall", {0, 0, 0}),   point("6", "wall", {0, 20, 0}),
                                       point("7", "wall", {0, 0, 8}),   point("8", "", {50, 0, 1}),      point("9", "", {60, 0, 1})};
  points[8].use = io::ControlUse::check;
  const auto targets = surveyed_targets(points, frame_, tally_);
  ASSERT_EQ(targets.size(), 4u);
  const SurveyedTarget& roof = targets[0];
  EXPECT_EQ(roof.name, "roof");
  EXPECT_FALSE(roof.is_point);
  EXPECT_LT((roof.normal - Vector3d(0, -1, 2).normalized()).norm(), rounding);
  EXPECT_LT((roof.centre - Vector3d(15, 5, 12.5)).norm(), rounding);
  ASSERT_EQ(roof.control.size(), 4u);
  EXPECT_EQ(roof.control[2].name, "3");
  EXPECT_LT((roof.control[2].point - Vector3d(30, 10, 15)).norm(), rounding);
  EXPECT_NEAR(roof.control[2].sigma, std::sqrt((0.01 * 0.01 + 4 * 0.02 * 0.02) / 5), 1e-12);
  EXPECT_LT((roof.corners[3] - Vector3d(0, 10, 15)).norm(), rounding);
  EXPECT_NEAR(targets[1].control[0].sigma, 0.01, 1e-12);  // a wall knows its points by their horizontal coordinates
  EXPECT_NEAR(std::abs(targets[1].normal.x()), 1, rounding);
  EXPECT_TRUE(targets[2].is_point);
  EXPECT_EQ(targets[2].name, "8");
  EXPECT_EQ(targets[2].control[0].sigma, 0.02);
  EXPECT_EQ(targets[2].normal, Vector3d::UnitZ());
  EXPECT_EQ(targets[3].use, io::ControlUse::check);
  EXPECT_TRUE(tally_.empty());
}

TEST_F(ControlTargets, ACornerOffThePlaneIsNamed) {
  std::vector<io::ControlPoint> points;
  for (int k = 0; k < 6; ++k)
    points.push_back(
        point("c" + std::to_string(k), "roof", {10 * std::cos(k * M_PI / 3), 10 * std::sin(k * M_PI / 3), k == 4 ? 0.3 : 0.0}));
  const auto targets = surveyed_targets(points, frame_, tally_);
  EXPECT_EQ(targets[0].control.size(), 6u);  // kept
  ASSERT_EQ(tally_.of(off_plane), 1u);
  EXPECT_NE(examples_of(tally_).find("roof: c4 lies 0.300 m off the plane of the others"), std::string::npos);
  // Of four corners none can be told from the others.
  surveyed_targets({points[1], points[2], points[4], points[5]}, frame_, tally_);
  EXPECT_EQ(tally_.of(off_plane), 2u);
  EXPECT_NE(examples_of(tally_).find("roof: any one of its corners lies "), std::string::npos);
  core::Tally good;
  for (io::ControlPoint& p : points) p.sigma_v = 0.2;
  surveyed_targets(points, frame_, good);
  EXPECT_TRUE(good.empty());
  // The leave-one-out distance of the wrong corner is its error.
  std::vector<Vector3d> corners;
  for (const auto& c : targets[0].corners) corners.push_back(c);
  const CornerPlane plane = corner_plane(corners, std::vector<double>(6, 0.02), std::vector<double>(6, 0.02));
  EXPECT_NEAR(plane.residual[4] / plane.redundancy[4], 0.3, 1e-3);
  double sum = 0;
  for (const double r : plane.redundancy) sum += r;
  EXPECT_NEAR(sum, 3, 1e-9);
}

TEST_F(ControlTargets, CornersOutOfTheirOrderAreTold) {
  constexpr const char* crossing = "surveyed targets whose outline crosses itself: their corners do not stand in their order around them";
  const std::vector<io::ControlPoint> around{point("1", "roof", {0, 0, 10}), point("2", "roof", {30, 0, 10}),
                                             point("3", "roof", {30, 10, 15}), point("4", "roof", {0, 10, 15})};
  surveyed_targets(around, frame_, tally_);
  surveyed_targets({around[3], around[2], around[1], around[0]}, frame_, tally_);
  EXPECT_TRUE(tally_.empty());
  surveyed_targets({around[0], around[2], around[1], around[3]}, frame_, tally_);
  EXPECT_EQ(tally_.of(crossing), 1u);
  // An L is no crossing.
  std::vector<io::ControlPoint> ell;
  for (const Vector3d& p :
       {Vector3d(0, 0, 0), Vector3d(20, 0, 0), Vector3d(20, 8, 0), Vector3d(8, 8, 0), Vector3d(8, 20, 0), Vector3d(0, 20, 0)})
    ell.push_back(point(std::to_string(ell.size()), "ell", p));
  surveyed_targets(ell, frame_, tally_);
  EXPECT_EQ(tally_.of(crossing), 1u);
}

TEST_F(ControlTargets, FourSigmasAreFourSigmas) {
  // Over many surveys of a four-cornered roof with true sigmas the misclosure in sigmas has mean square 1, so that hardly one is named.
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  constexpr int surveys = 2000;
  double squares = 0;
  for (int s = 0; s < surveys; ++s) {
    std::vector<Vector3d> corners;
    for (const Vector3d& c : {Vector3d(0, 0, 0), Vector3d(20, 0, 0), Vector3d(20, 10, 4), Vector3d(0, 10, 4)})
      corners.push_back(c + Vector3d(0.01 * noise(random), 0.01 * noise(random), 0.03 * noise(random)));
    const CornerPlane p = corner_plane(corners, std::vector<double>(4, 0.01), std::vector<double>(4, 0.03));
    squares += p.residual[0] * p.residual[0] / (p.sigma[0] * p.sigma[0] * p.redundancy[0]);
  }
  EXPECT_NEAR(squares / surveys, 1.0, 4 * std::sqrt(2.0 / surveys));  // four sigmas of a chi-square mean
}

}  // namespace
}  // namespace swath::calib
