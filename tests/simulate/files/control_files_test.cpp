// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/control_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace swath::simulate {
namespace {

Options options() {
  Options o;
  o.world.scene = Scene::airfield;
  o.world.length = o.world.width = core::Metres(720);
  o.control.roof = true;
  o.control.targets = 5;
  o.control.points = 20;
  return o;
}

std::vector<SurveyedPoint> surveyed(const Options& o) {
  const World world(o.world, o.seed, o.flight.direction, 900);
  return survey_points(o, world, facets_of(world));
}

TEST(ControlFiles, ErrorsHaveTheStatedSigma) {
  Options o = options();
  Eigen::Vector3d square = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  double n = 0;
  for (o.seed = 0; o.seed < 100; ++o.seed)
    for (const SurveyedPoint& p : surveyed(o)) {
      const Eigen::Vector3d e = (p.surveyed - p.truth) / o.control.sigma.value;
      square += e.cwiseAbs2();
      sum += e;
      ++n;
    }
  EXPECT_GT(n, 4000);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(std::sqrt(square[k] / n), 1.0, 5 * std::sqrt(0.5 / n));
    EXPECT_NEAR(sum[k] / n, 0.0, 5 / std::sqrt(n));
  }
}

TEST(ControlFiles, TargetsAreFacetsSpreadOverTheArea) {
  const Options o = options();
  const World world(o.world, o.seed, o.flight.direction, 900);
  const std::vector<Facet> facets = facets_of(world);
  const std::vector<SurveyedPoint> points = survey_points(o, world, facets);
  std::vector<std::string> targets;
  std::vector<Eigen::Vector2d> middles;
  for (size_t i = 0; i < points.size() && !points[i].target.empty();) {
    const auto f = std::find_if(facets.begin(), facets.end(), [&](const Facet& v) { return v.name == points[i].target; });
    ASSERT_NE(f, facets.end());
    EXPECT_TRUE(f->roof);
    for (const Eigen::Vector3d& c : f->corners) EXPECT_EQ(points[i++].truth, c);
    targets.push_back(f->name);
    middles.push_back(f->corners[0].head<2>());
  }
  ASSERT_EQ(targets.size(), 6u);
  EXPECT_EQ(targets[0], "building roof 1");
  for (size_t i = 0; i < middles.size(); ++i)
    for (size_t k = 0; k < i; ++k) EXPECT_GT((middles[i] - middles[k]).norm(), 150.0) << targets[i] << ", " << targets[k];
}

TEST(ControlFiles, GroundPointsStandOnOpenGround) {
  const Options o = options();
  const World world(o.world, o.seed, o.flight.direction, 900);
  int ground = 0;
  for (const SurveyedPoint& p : survey_points(o, world, facets_of(world))) {
    if (!p.target.empty()) continue;
    ++ground;
    EXPECT_EQ(p.truth.z(), world.relief().height(p.truth.x(), p.truth.y()));
    for (const Building& b : world.buildings()) {
      const bool inside =
          std::all_of(b.planes.begin(), b.planes.end(), [&](const Eigen::Vector4d& v) { return v.head<3>().dot(p.truth) < v[3] + 1.0; });
      EXPECT_FALSE(inside) << p.name;
    }
  }
  EXPECT_EQ(ground, 20);
}

TEST(ControlFiles, OnePartDoesNotChangeAnother) {
  Options o = options();
  const std::vector<SurveyedPoint> all = surveyed(o);
  o.control.targets = 0;
  o.control.points = 0;
  const std::vector<SurveyedPoint> roof = surveyed(o);
  ASSERT_EQ(roof.size(), 4u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(roof[i].surveyed, all[i].surveyed);
  o.control.roof = false;
  EXPECT_TRUE(surveyed(o).empty());
}

TEST(ControlFiles, ShiftIsAddedToWhatWasSurveyedAlone) {
  Options o = options();
  const std::vector<SurveyedPoint> right = surveyed(o);
  o.control.shift = {core::Metres(3.0), core::Metres(-2.0), core::Metres(47.0)};
  const std::vector<SurveyedPoint> wrong = surveyed(o);
  for (size_t i = 0; i < right.size(); ++i) {
    EXPECT_LT((wrong[i].surveyed - right[i].surveyed - Eigen::Vector3d(3.0, -2.0, 47.0)).norm(), 1e-9);
    EXPECT_EQ(wrong[i].truth, right[i].truth);
  }
}

TEST(ControlFiles, WithoutBuildingsThereIsNoRoofAndNoTarget) {
  Options o = options();
  o.world.buildings = 0.0;
  EXPECT_THROW(surveyed(o), core::Error);
  o.control.targets = 0;
  EXPECT_EQ(surveyed(o).size(), 20u);
}

}  // namespace
}  // namespace swath::simulate
