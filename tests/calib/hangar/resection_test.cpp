// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/resection.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>
#include <random>

#include "tests/calib/made_hangar.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double rounding = 1e-9;     // m, of exact distances of some ten metres through the adjustment
constexpr double reference = 1e-6;    // m, as the reference asks
constexpr double sigma_share = 1e-3;  // of a sigma, as the reference asks

std::vector<TargetDistance> exact(const std::vector<Vector3d>& targets, const Vector3d& station) {
  std::vector<TargetDistance> out;
  for (const Vector3d& t : targets) out.push_back({t, (t - station).norm(), 0.002});
  return out;
}

TEST(Resection, JacobianIsThatOfCentralDifferences) {
  const Vector3d target(1, -2, 3);
  constexpr double h = 1e-6;
  for (const Vector3d& s : {Vector3d(4, 5, 6), Vector3d(1, -2, 3.001), Vector3d(-100, 30, 2)}) {
    const DistanceModel m = distance_model(s, target);
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = h * Vector3d::Unit(k);
      EXPECT_NEAR(m.by_station[k], (distance_model(s + d, target).distance - distance_model(s - d, target).distance) / (2 * h), 1e-6);
    }
  }
  EXPECT_EQ(distance_model(target, target).by_station.norm(), 0);
}

TEST(Resection, ExactDistancesWithoutAStartValue) {
  test::MadeHangar made;
  made.build();
  for (const Vector3d& station : made.stations) {
    const Resection r = resect(exact(made.targets, station));
    ASSERT_EQ(r.state, ResectionState::solved);
    EXPECT_LT((r.position - station).norm(), rounding);
    EXPECT_NEAR(r.scale, 1, 1e-6);
    EXPECT_EQ(r.redundancy, 44);
  }
}

TEST(Resection, OneSidedTargetsAndTheMirror) {
  // A nearly flat wall of targets: the station's mirror image lies behind it, and fits within a few sigmas or not at all.
  const Vector3d station(3, 8, 1);
  for (const double relief : {0.0, 0.0005, 0.5}) {
    std::vector<Vector3d> targets;
    for (int k = 0; k < 8; ++k) targets.push_back({0.9 * k, relief * std::sin(1.7 * k), std::fmod(0.618 * k, 1.0) * 3});
    const Vector3d behind(3, -8, 1);
    const Resection alone = resect(exact(targets, station)), right = resect(exact(targets, station), station + Vector3d(1, 1, 1)),
                    wrong = resect(exact(targets, station), behind);
    ASSERT_TRUE(alone.mirror.has_value());
    if (relief > 0.1) {
      EXPECT_EQ(alone.state, ResectionState::solved);
      EXPECT_GT(alone.mirror_variance_factor, 100);
      EXPECT_FALSE(right.start_led_to_mirror);
      EXPECT_TRUE(wrong.start_led_to_mirror);
      EXPECT_LT((wrong.position - station).norm(), rounding);
    } else {
      EXPECT_EQ(alone.state, ResectionState::two_fit);
      EXPECT_EQ(right.state, ResectionState::solved);
      EXPECT_TRUE(right.decided_by_start);
      EXPECT_LT((right.position - station).norm(), rounding);
      EXPECT_LT((wrong.position - behind).norm(), 0.01);
    }
  }
}

TEST(Resection, WhatIsNotDetermined) {
  const Vector3d station(3, 8, 1);
  const std::vector<Vector3d> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
  EXPECT_EQ(resect(exact(line, station)).state, ResectionState::in_line);
  EXPECT_EQ(resect(exact({line[0], line[1]}, station)).state, ResectionState::too_few);
  const std::vector<Vector3d> level{{0, 0, 1}, {9, 0, 1}, {9, 9, 1}, {0, 9, 1}, {4, 0, 1}};
  EXPECT_EQ(resect(exact(level, station)).state, ResectionState::weak);
  const Resection three = resect(exact({level[0], level[1], level[2]}, {3, 8, 5}), Vector3d(3, 8, 4));
  EXPECT_EQ(three.state, ResectionState::solved);
  EXPECT_EQ(three.redundancy, 0);
  EXPECT_TRUE(std::isnan(three.variance_factor));
  EXPECT_EQ(three.w, (std::vector<double>{0, 0, 0}));
}

TEST(Resection, AStationInThePlaneOfItsTargetsIsRefused) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::vector<Vector3d> level{{0, 0, 1}, {9, 0, 1}, {9, 9, 1}, {0, 9, 1}, {4, 0, 1}, {9, 5, 1}, {0, 4, 1}, {4, 9, 1}};
  int solved = 0;
  for (int k = 0; k < 200; ++k)
    for (const double above : {0.0, 0.01, 3.0}) {
      const Vector3d station(3, 7, 1 + above);
      auto distances = exact(level, station);
      for (TargetDistance& d : distances) d.distance += d.sigma * normal(random);
      // A start value says on which side it stands, not how far.
      const Resection r = resect(distances, station + Vector3d(0, 0, 0.1));
      if (above > 1.0) {
        solved += r.state == ResectionState::solved;
      } else {
        EXPECT_EQ(r.state, ResectionState::weak) << k;
      }
    }
  EXPECT_EQ(solved, 200);
}

TEST(Resection, AnotherUnitAndABlunderAreTold) {
  test::MadeHangar made;
  made.build();
  auto distances = exact(made.targets, made.stations[0]);
  distances.resize(12);
  auto feet = distances;
  for (TargetDistance& d : feet) d.distance /= 0.3048;
  EXPECT_NEAR(resect(feet).scale, 0.3048, 1e-6);
  distances[5].distance += 0.05;
  const Resection r = resect(distances);
  for (size_t i = 0; i < distances.size(); ++i) EXPECT_LE(std::abs(r.w[i]), r.w[5]);
  EXPECT_GT(r.w[5], 10);
}

TEST(Resection, ErrorsAreAsLargeAsTheirSigmas) {
  test::MadeHangar made;
  made.build();
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  constexpr int seeds = 500;
  Vector3d squares = Vector3d::Zero();
  double factors = 0;
  for (int s = 0; s < seeds; ++s) {
    std::vector<Vector3d> every_third;
    for (size_t t = 0; t < made.targets.size(); t += 3) every_third.push_back(made.targets[t]);
    auto distances = exact(every_third, made.stations[3]);
    for (TargetDistance& d : distances) d.distance += d.sigma * normal(random);
    const Resection r = resect(distances);
    ASSERT_EQ(r.state, ResectionState::solved);
    squares += ((r.position - made.stations[3]).array().square() / r.covariance.diagonal().array()).matrix() / seeds;
    factors += r.variance_factor / seeds;
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::sqrt(squares[k]), 1, 0.1);  // three sigmas of a rms of 500
  EXPECT_NEAR(factors, 1, 0.1);
}

TEST(ResectionReference, SixStations) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p001_survey.json");
  rapidjson::Document d;
  d.Parse(test::read_bytes(file).c_str());
  const auto vector = [](const rapidjson::Value& v) { return Vector3d(v[0].GetDouble(), v[1].GetDouble(), v[2].GetDouble()); };
  for (const auto& s : d["resection"].GetArray()) {
    std::vector<TargetDistance> distances;
    for (rapidjson::SizeType i = 0; i < s["targets"].Size(); ++i) {
      const double length = s["distances"][i].GetDouble();
      distances.push_back({vector(d["targets"][s["targets"][i].GetUint()]), length, 0.002 + 2e-6 * length});
    }
    const auto& expected = s["expected"];
    for (const std::optional<Vector3d>& start : {std::optional<Vector3d>(), std::optional(vector(s["start"]))}) {
      const Resection r = resect(distances, start);
      ASSERT_EQ(r.state, ResectionState::solved);
      EXPECT_LT((r.position - vector(expected["x"])).norm(), reference);
      EXPECT_NEAR(r.variance_factor, expected["sigma0_sq"].GetDouble(), reference);
      for (rapidjson::SizeType i = 0; i < 3; ++i) {
        const double sd = 1e-3 * expected["sd_mm"][i].GetDouble();
        EXPECT_NEAR(std::sqrt(r.covariance(i, i)), sd, sigma_share * sd);
        for (rapidjson::SizeType j = 0; j < 3; ++j)
          EXPECT_NEAR(r.covariance(i, j), expected["cov"][i][j].GetDouble(),
                      sigma_share * std::sqrt(r.covariance(i, i) * r.covariance(j, j)));
      }
      for (rapidjson::SizeType i = 0; i < expected["residuals"].Size(); ++i)
        EXPECT_NEAR(r.residual[i], expected["residuals"][i].GetDouble(), reference);
    }
  }
}

}  // namespace
}  // namespace swath::calib
