// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/combined_point.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double reference = 1e-6;    // m, as the reference asks
constexpr double sigma_share = 1e-3;  // of a sigma, as the reference asks
constexpr double arc_second = core::degree / 3600;

const std::vector<Vector3d> stations{{0, 0, 1.5}, {7, 1, 1.6}, {6, 8, 1.9}, {-1, 7, 1.4}};

/// Everything that can be measured at points from four stations, without noise.
PointNetwork exact(const std::vector<Vector3d>& points) {
  PointNetwork n;
  n.points = points.size();
  n.stations = stations;
  n.station_covariance = MatrixXd::Identity(12, 12) * 1e-6;
  for (size_t p = 0; p < points.size(); ++p)
    for (size_t s = 0; s < stations.size(); ++s) {
      const Vector3d d = points[p] - stations[s];
      for (size_t o = 0; o < stations.size(); ++o) {
        if (o == s) continue;
        const Vector3d base = stations[o] - stations[s];
        n.angles.push_back({s, o, p, std::abs(core::wrap_pi(std::atan2(d.y(), d.x()) - std::atan2(base.y(), base.x()))), 5 * arc_second});
      }
      n.verticals.push_back({s, p, std::atan2(d.z(), d.head<2>().norm()), 5 * arc_second});
      n.distances.push_back({s, p, d.norm(), 0.002});
    }
  return n;
}

VectorXd column(const std::vector<Vector3d>& points) {
  VectorXd out(static_cast<Index>(3 * points.size()));
  for (size_t p = 0; p < points.size(); ++p) out.segment<3>(static_cast<Index>(3 * p)) = points[p];
  return out;
}

const std::vector<Vector3d> two{{2.5, 3.5, 0.7}, {4.0, 5.0, 2.6}};

TEST(CombinedPoint, JacobiansAreThoseOfCentralDifferences) {
  constexpr double h = 1e-6, tolerance = 1e-7;  // relative to values of some metres
  for (const bool held : {false, true}) {
    PointNetwork n = exact(two);
    n.signed_elevations = true;
    if (held) n.station_covariance.resize(0, 0);
    const auto conditions = conditions_of(n);
    const VectorXd x = column(two) + VectorXd::Constant(6, 0.01), l = observations_of(n);
    const Misclosures m = misclosures(n, conditions, x, l);
    EXPECT_EQ(m.value.size(), 2 * (6 * 2 + 4 + 4));
    for (Index k = 0; k < x.size(); ++k) {
      const VectorXd d = h * VectorXd::Unit(x.size(), k);
      const VectorXd numeric = (misclosures(n, conditions, x + d, l).value - misclosures(n, conditions, x - d, l).value) / (2 * h);
      EXPECT_LT((m.by_points.col(k) - numeric).cwiseAbs().maxCoeff(), tolerance) << k;
    }
    for (Index k = 0; k < l.size(); ++k) {
      const VectorXd d = h * VectorXd::Unit(l.size(), k);
      const VectorXd numeric = (misclosures(n, conditions, x, l + d).value - misclosures(n, conditions, x, l - d).value) / (2 * h);
      const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
      EXPECT_LT((m.by_observations.col(k) - numeric).cwiseAbs().maxCoeff(), tolerance * scale * scale) << k;
    }
  }
}

TEST(CombinedPoint, ExactSightsCloseAndGiveThePoints) {
  const PointNetwork n = exact(two);
  EXPECT_LT(misclosures(n, conditions_of(n), column(two), observations_of(n)).value.norm(), 1e-12);
  const FoundPoints found = find_points(n, {});
  ASSERT_TRUE(found.adjusted.solved);
  EXPECT_LT((found.adjusted.points - column(two)).norm(), 1e-9);
  for (const PointSearch& s : found.searches) {
    EXPECT_EQ(s.state, PointState::solved);
    EXPECT_FALSE(s.elevations_contradict);
  }
}

TEST(CombinedPoint, AMirroredStartIsFoundOut) {
  const PointNetwork n = exact({two[0]});
  const Vector3d above(2.5, 3.5, 2.6);
  const CombinedPoints wrong = adjust_points(n, above);  // the adjustment itself ends above the stations
  EXPECT_GT(wrong.points[2], 1.9);
  EXPECT_GT(wrong.squares, 1000);
  const FoundPoints found = find_points(n, {above});
  ASSERT_TRUE(found.adjusted.solved);
  EXPECT_LT((found.adjusted.points - two[0]).norm(), 1e-9);
  EXPECT_TRUE(found.searches[0].start_led_to_mirror);
  EXPECT_GT(found.searches[0].mirror_variance_factor, 100);
  EXPECT_FALSE(find_points(n, {two[0]}).searches[0].start_led_to_mirror);
}

TEST(CombinedPoint, LevelStationsLeaveItToTheSignOfTheVerticalAngles) {
  PointNetwork n = exact({two[0]});
  for (Vector3d& s : n.stations) s.z() = 1.5;
  const Vector3d point = two[0];
  n.verticals.clear();
  n.distances.clear();
  for (size_t s = 0; s < n.stations.size(); ++s) {
    const Vector3d d = point - n.stations[s];
    n.verticals.push_back({s, 0, std::atan2(d.z(), d.head<2>().norm()), 5 * arc_second});
    n.distances.push_back({s, 0, d.norm(), 0.002});
  }
  const FoundPoints found = find_points(n, {});
  ASSERT_EQ(found.searches[0].state, PointState::solved);
  EXPECT_TRUE(found.searches[0].decided_by_elevation);
  EXPECT_LT((found.adjusted.points - point).norm(), 1e-6);
  // Angles that count downwards turn the point over; with stations at several heights that is found out.
  PointNetwork turned = exact({two[0]});
  for (VerticalAngle& v : turned.verticals) v.angle = -v.angle;
  EXPECT_TRUE(find_points(turned, {}).searches[0].elevations_contradict);
  // Distances alone know no side.
  n.angles.clear();
  n.verticals.clear();
  EXPECT_EQ(find_points(n, {}).searches[0].state, PointState::two_fit);
  const PointSearch decided = find_points(n, {Vector3d(2, 3, 0)}).searches[0];
  EXPECT_EQ(decided.state, PointState::solved);
  EXPECT_TRUE(decided.decided_by_start);
  EXPECT_LT(decided.position.z(), 1.5);
}

TEST(CombinedPoint, APointAsHighAsItsStationsNeedsTheSigns) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Vector3d point(2.5, 3.5, 1.55);
  constexpr int seeds = 200;
  double squares = 0;
  for (int k = 0; k < seeds; ++k) {
    PointNetwork n = exact({point});  // from stations at several heights, all near the point's
    n.signed_elevations = true;
    for (HorizontalAngle& a : n.angles) a.angle += a.sigma * normal(random);
    for (VerticalAngle& a : n.verticals) a.angle += a.sigma * normal(random);
    for (PointDistance& d : n.distances) d.distance += d.sigma * normal(random);
    for (size_t s = 0; s < stations.size(); ++s)
      for (Index c = 0; c < 3; ++c) n.stations[s][c] += 0.001 * normal(random);
    const FoundPoints found = find_points(n, {});
    ASSERT_EQ(found.searches[0].state, PointState::solved);
    EXPECT_LT(std::sqrt(found.adjusted.covariance(2, 2)), 0.001);
    squares += std::pow(found.adjusted.points[2] - point.z(), 2) / found.adjusted.covariance(2, 2) / seeds;
  }
  EXPECT_NEAR(std::sqrt(squares), 1, 0.15);  // three sigmas of a rms of 200
}

/// A survey from four stations of one height without the signs of vertical angles; the point `above` them.
PointNetwork without_signs(double above, std::mt19937& random) {
  std::normal_distribution<double> normal;
  PointNetwork n;
  n.points = 1;
  const Vector3d point(2.5, 3.5, 1.5 + above);
  n.stations = stations;
  for (Vector3d& s : n.stations) s.z() = 1.5;
  n.station_covariance = MatrixXd::Identity(12, 12) * 1e-8;
  for (size_t s = 0; s < n.stations.size(); ++s) {
    const Vector3d d = point - n.stations[s];
    for (size_t o = 0; o < n.stations.size(); ++o) {
      if (o == s) continue;
      const Vector3d base = n.stations[o] - n.stations[s];
      const double angle = std::abs(core::wrap_pi(std::atan2(d.y(), d.x()) - std::atan2(base.y(), base.x())));
      n.angles.push_back({s, o, 0, angle + 5 * arc_second * normal(random), 5 * arc_second});
    }
    n.verticals.push_back({s, 0, std::atan2(d.z(), d.head<2>().norm()) + 5 * arc_second * normal(random), 5 * arc_second});
    n.distances.push_back({s, 0, d.norm() + 0.002 * normal(random), 0.002});
  }
  for (Vector3d& s : n.stations)
    for (Index c = 0; c < 3; ++c) s[c] += 1e-4 * normal(random);
  return n;
}

TEST(CombinedPoint, WithoutTheSignsAPointAsHighAsItsStationsIsRefused) {
  std::mt19937 random(9);
  for (int k = 0; k < 100; ++k) {
    const PointNetwork n = without_signs(0.0, random);
    // Neither one of two heights that noise has made, nor a start value, makes it known.
    EXPECT_EQ(find_points(n, {}).searches[0].state, PointState::weak) << k;
    EXPECT_EQ(find_points(n, {Vector3d(2.5, 3.5, 1.6)}).searches[0].state, PointState::weak) << k;
  }
}

TEST(CombinedPoint, WithoutTheSignsHeightsThatAreTakenHaveTrueSigmas) {
  std::mt19937 random(10);
  constexpr int seeds = 200;
  int taken = 0, refused = 0;
  double squares = 0;
  for (const double above : {0.0002, 0.001, 0.01, 0.1, 0.5})
    for (int k = 0; k < seeds; ++k) {
      const PointNetwork n = without_signs(above, random);
      const FoundPoints found = find_points(n, {Vector3d(2.5, 3.5, 1.5 + above)});
      if (found.searches[0].state != PointState::solved) {
        EXPECT_EQ(found.searches[0].state, PointState::weak);
        ++refused;
        continue;
      }
      ++taken;
      squares += std::pow(found.adjusted.points[2] - 1.5 - above, 2) / found.adjusted.covariance(2, 2);
    }
  EXPECT_GT(taken, 2 * seeds);
  EXPECT_GT(refused, seeds);
  EXPECT_NEAR(std::sqrt(squares / taken), 1, 0.1);
}

TEST(CombinedPoint, WhatIsNotDetermined) {
  PointNetwork n = exact({two[0]});
  n.angles.clear();
  n.verticals.clear();
  n.distances.resize(2);
  EXPECT_EQ(find_points(n, {}).searches[0].state, PointState::too_few);
  n.stations = {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}};
  n.distances.push_back({2, 0, 3.0, 0.002});
  EXPECT_EQ(find_points(n, {}).searches[0].state, PointState::not_determined);
}

TEST(CombinedPoint, ErrorsAreAsLargeAsTheirSigmasAndSharedOnesCancel) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int seeds = 300;
  const double station_sigma[] = {0.001, 0.001, 0.004};
  double squares = 0, factor = 0, difference = 0;
  double held = 0;
  for (int k = 0; k < seeds; ++k) {
    PointNetwork n = exact(two);
    for (HorizontalAngle& a : n.angles) a.angle += a.sigma * normal(random);
    for (VerticalAngle& a : n.verticals) a.angle += a.sigma * normal(random);
    for (PointDistance& d : n.distances) d.distance += d.sigma * normal(random);
    for (size_t s = 0; s < stations.size(); ++s)
      for (Index c = 0; c < 3; ++c) {
        n.stations[s][c] += station_sigma[c] * normal(random);
        const auto i = static_cast<Index>(3 * s) + c;
        n.station_covariance(i, i) = station_sigma[c] * station_sigma[c];
      }
    const CombinedPoints a = find_points(n, {}).adjusted;
    ASSERT_TRUE(a.solved);
    const VectorXd error = a.points - column(two);
    squares += (error.array().square() / a.covariance.diagonal().array()).mean() / seeds;
    factor += a.variance_factor / seeds;
    MatrixXd D(3, 6);
    D << MatrixXd::Identity(3, 3), -MatrixXd::Identity(3, 3);
    const Eigen::Matrix3d c = D * a.covariance * D.transpose();
    difference += ((D * error).array().square() / c.diagonal().array()).mean() / seeds;
    n.station_covariance.resize(0, 0);
    const CombinedPoints h = adjust_points(n, column(two));
    held += ((h.points - column(two)).array().square() / h.covariance.diagonal().array()).mean() / seeds;
  }
  EXPECT_NEAR(std::sqrt(squares), 1, 0.1);
  EXPECT_NEAR(std::sqrt(difference), 1, 0.1);
  EXPECT_NEAR(factor, 1, 0.1);
  EXPECT_GT(std::sqrt(held), 5);  // stations taken as free of error: sigmas far too small
}

TEST(CombinedPointReference, TheThreeAdjustments) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p001_survey.json");
  rapidjson::Document d;
  d.Parse(test::read_bytes(file).c_str());
  const auto vector = [](const rapidjson::Value& v) { return Vector3d(v[0].GetDouble(), v[1].GetDouble(), v[2].GetDouble()); };
  const auto& cp = d["cp"];
  PointNetwork network;
  network.points = 1;
  for (const auto& s : d["table1"].GetArray()) network.stations.push_back(vector(s));
  std::map<std::tuple<size_t, size_t>, double> angles;
  std::map<size_t, double> verticals;
  const double sd = cp["angle_sd_rad"].GetDouble();
  for (const auto& o : cp["pairs_and_distances"].GetArray()) {
    const size_t a = o["A"].GetUint();
    const std::string kind = o["kind"].GetString();
    if (kind == "D") {
      network.distances.push_back({a, 0, o["D"].GetDouble(), o["s_d"].GetDouble()});
      continue;
    }
    const size_t b = o["B"].GetUint();
    angles[{a, b}] = o["alpha"].GetDouble();
    angles[{b, a}] = o["beta"].GetDouble();
    verticals[kind == "A" ? a : b] = o["gamma"].GetDouble();
  }
  for (const auto& [key, angle] : angles) network.angles.push_back({std::get<0>(key), std::get<1>(key), 0, angle, sd});
  for (const auto& [s, angle] : verticals) network.verticals.push_back({s, 0, angle, sd});

  const auto check = [&](const PointNetwork& n, const char* name) {
    const auto& expected = cp["expected"][name];
    const Vector3d mirrored(50, 50, 51.1);
    for (const std::optional<Vector3d>& start : {std::optional<Vector3d>(), std::optional(mirrored)}) {
      const FoundPoints found = find_points(n, {start});
      const CombinedPoints& a = found.adjusted;
      ASSERT_TRUE(a.solved) << name;
      EXPECT_LT((a.points - vector(expected["x"])).norm(), reference) << name;
      for (rapidjson::SizeType i = 0; i < 3; ++i) {
        const double sigma = 1e-3 * expected["sd_mm"][i].GetDouble();
        EXPECT_NEAR(std::sqrt(a.covariance(i, i)), sigma, sigma_share * sigma) << name;
      }
      EXPECT_EQ(found.searches[0].start_led_to_mirror, start.has_value()) << name;
      EXPECT_FALSE(found.searches[0].elevations_contradict);
      if (!expected.HasMember("s02")) continue;
      EXPECT_NEAR(a.variance_factor, expected["s02"].GetDouble(), 1e-6) << name;
      EXPECT_EQ(a.redundancy, expected["dof"].GetInt());
      if (start) {
        EXPECT_GT(found.searches[0].mirror_variance_factor, 100) << name;
      }
    }
  };
  check(network, "fixed stations (Table 1)");
  network.station_covariance = MatrixXd::Zero(18, 18);
  for (Index s = 0; s < 6; ++s)
    for (Index k = 0; k < 3; ++k)
      network.station_covariance(3 * s + k, 3 * s + k) =
          cp["station_cov_table1"][static_cast<rapidjson::SizeType>(s)][static_cast<rapidjson::SizeType>(k)].GetDouble();
  check(network, "stations with Table 1 sigmas");
  PointNetwork blunt = network;
  for (HorizontalAngle& a : blunt.angles) a.sigma = 30 * arc_second;
  for (VerticalAngle& a : blunt.verticals) a.sigma = 30 * arc_second;
  const CombinedPoints pointing = find_points(blunt, {}).adjusted;
  for (rapidjson::SizeType i = 0; i < 3; ++i) {
    const double sigma = 1e-3 * cp["expected"]["pointing 30 arcsec, Table 1 sigmas"]["sd_mm"][i].GetDouble();
    EXPECT_NEAR(std::sqrt(pointing.covariance(i, i)), sigma, sigma_share * sigma);
  }
  PointNetwork only_angles = network, only_distances = network;
  only_angles.distances.clear();
  check(only_angles, "angles only, Table 1 sigmas");
  only_distances.angles.clear();
  only_distances.verticals.clear();
  const auto& alone = cp["expected"]["distances only, Table 1 sigmas"];
  const CombinedPoints by_distances = adjust_points(only_distances, Vector3d(50, 50, 49));
  ASSERT_TRUE(by_distances.solved);
  EXPECT_LT((by_distances.points - vector(alone["x"])).norm(), reference);
  for (rapidjson::SizeType i = 0; i < 3; ++i)
    EXPECT_NEAR(std::sqrt(by_distances.covariance(i, i)), 1e-3 * alone["sd_mm"][i].GetDouble(),
                1e-3 * sigma_share * alone["sd_mm"][i].GetDouble());
  for (rapidjson::SizeType s = 0; s < 6; ++s) {
    const auto& own = d["resection"][s]["expected"];
    network.stations[s] = vector(own["x"]);
    for (rapidjson::SizeType i = 0; i < 3; ++i)
      for (rapidjson::SizeType j = 0; j < 3; ++j)
        network.station_covariance(static_cast<Index>(3 * s + i), static_cast<Index>(3 * s + j)) = own["cov"][i][j].GetDouble();
  }
  check(network, "stations of (i) with full covariance");
}

}  // namespace
}  // namespace swath::calib
