// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/roof_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double roof_height = 12.0;

/// A hall of 40 m by 20 m, turned by 25 degrees, on level ground.
struct Hall {
  Vector2d middle{100.0, 80.0};
  double turn = 0.4363;
  Vector2d along() const { return {std::cos(turn), std::sin(turn)}; }
  Vector2d across() const { return {-std::sin(turn), std::cos(turn)}; }
  RoofTarget target(const std::string& name, bool clockwise = false) const {
    RoofTarget t{name, {}, 0.01};
    for (const auto& [a, c] : {std::pair(-20, -10), std::pair(20, -10), std::pair(20, 10), std::pair(-20, 10)}) {
      const Vector2d p = middle + a * along() + c * across();
      t.corners.emplace_back(1000.0 + p.x(), 2000.0 + p.y(), roof_height);
    }
    if (clockwise) std::reverse(t.corners.begin(), t.corners.end());
    return t;
  }
};

/// `density` returns per m2 with places off by 4 cm, all moved by `shift`; `annex`: the roof goes on beyond its first edge.
core::Block cloud(const Hall& hall, double density, const Vector2d& shift, unsigned seed, bool annex = false) {
  core::Block b;
  b.origin = {1000.0, 2000.0, 0.0};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(60.0, 140.0), y(40.0, 120.0);
  std::normal_distribution<double> error(0.0, 0.04);
  const auto count = static_cast<size_t>(density * 80.0 * 80.0);
  for (size_t k = 0; k < count; ++k) {
    const Vector2d p(x(random), y(random)), d = p - hall.middle;
    const double a = d.dot(hall.along()), c = d.dot(hall.across());
    const bool roof = std::abs(a) < 20.0 && c < 10.0 && c > (annex ? -18.0 : -10.0);
    b.x.push_back(p.x() + shift.x() + error(random)), b.y.push_back(p.y() + shift.y() + error(random));
    b.z.push_back(roof ? roof_height : 0.0);
    b.flags.push_back(0), b.classification.push_back(roof ? 6 : 2);
  }
  return b;
}

TEST(RoofEdges, ShiftsPutInAreRecoveredWithinTheirSigma) {
  const Hall hall;
  double chi = 0.0;
  int n = 0;
  for (const double size : {0.0, 0.05, 0.10})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Vector2d shift = size * Vector2d(std::cos(seed), std::sin(seed));
      const std::vector<RoofTarget> targets{hall.target("hall", seed % 2 == 0)};
      const core::Block b = cloud(hall, 8.0, shift, seed);
      const auto found = roof_shifts(targets, edge_returns(b, b.size(), targets));
      ASSERT_EQ(found.size(), 1u);
      EXPECT_EQ(found[0].edges, 4u);
      EXPECT_LT(found[0].sigma_east, 0.05);
      EXPECT_NEAR(found[0].east, shift.x(), 0.04);  // three sigma
      EXPECT_NEAR(found[0].north, shift.y(), 0.04);
      chi +=
          std::pow((found[0].east - shift.x()) / found[0].sigma_east, 2) + std::pow((found[0].north - shift.y()) / found[0].sigma_north, 2);
      n += 2;
    }
  EXPECT_NEAR(std::sqrt(chi / n), 1.0, 0.4);
}

TEST(RoofEdges, ScanLinesAlongAnEdgeShowItBetweenTwoOfThemOnly) {
  Hall hall;
  hall.turn = 0.0;
  const std::vector<RoofTarget> targets{hall.target("hall")};
  core::Block b = cloud(hall, 8.0, {0.0, 0.0}, 3);
  for (size_t p = 0; p < b.size(); ++p) {
    b.y[p] = 0.7 * std::round(b.y[p] / 0.7);
    const bool roof = std::abs(b.x[p] - 100.0) < 20.0 && std::abs(b.y[p] - 80.0) < 10.0;
    b.z[p] = roof ? roof_height : 0.0;
  }
  const auto found = roof_shifts(targets, edge_returns(b, b.size(), targets));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0].sigma_east, 0.05);
  EXPECT_GT(found[0].sigma_north, 0.1);
  EXPECT_NEAR(found[0].north, 0.0, 0.35);
}

TEST(RoofEdges, AnEdgeWhereTheRoofGoesOnIsNotUsedAndTilesChangeNothing) {
  const Hall hall;
  const std::vector<RoofTarget> targets{hall.target("hall")};
  const core::Block b = cloud(hall, 8.0, {0.1, 0.0}, 3, true);
  std::vector<EdgeReturn> returns = edge_returns(b, b.size(), targets);
  const auto found = roof_shifts(targets, returns);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].edges, 3u);
  EXPECT_EQ(found[0].misfit, 0.0);
  EXPECT_NEAR(found[0].east, 0.1, 0.08);
  std::reverse(returns.begin(), returns.end());
  EXPECT_EQ(roof_shifts(targets, returns)[0].east, found[0].east);
}

TEST(RoofEdges, RoofsThatAreNotThereOrHaveTwoEdgesGiveNothing) {
  const Hall hall;
  Hall far;
  far.middle = {500.0, 500.0};
  RoofTarget two = hall.target("strip");  // its long edges alone are on roofs' rims
  const core::Block b = cloud(hall, 8.0, {0.0, 0.0}, 3);
  for (size_t k = 0; k < 4; ++k) two.corners[k].head<2>() += (k == 0 || k == 3 ? 8.0 : -8.0) * hall.along();
  const std::vector<RoofTarget> targets{far.target("far"), two};
  EXPECT_TRUE(roof_shifts(targets, edge_returns(b, b.size(), targets)).empty());
}

TEST(RoofEdges, PlanimetryAddsTheTargetsError) {
  const std::vector<RoofTarget> targets{{"a", {}, 0.03}, {"b", {}, 0.03}};
  const RoofPlanimetry p =
      planimetry_of(targets, {{"a", 4, 100, 0.05, 0.00, 0.01, 0.01, 0, 0}, {"b", 4, 100, 0.03, 0.04, 0.01, 0.01, 0, 0}});
  EXPECT_EQ(p.roofs, 2u);
  EXPECT_NEAR(p.east, 0.04, 1e-12);
  EXPECT_NEAR(p.north, 0.02, 1e-12);
  EXPECT_NEAR(p.sigma_east, std::sqrt((0.0001 + 0.0009) / 2.0), 1e-12);
  EXPECT_NEAR(p.rmse_east, std::sqrt((0.0025 + 0.0009) / 2.0), 1e-12);
  EXPECT_NEAR(p.rmse, std::sqrt((0.0025 + 0.0009) / 2.0 + 0.0016 / 2.0), 1e-12);
  EXPECT_NEAR(p.with_targets, std::sqrt(p.rmse * p.rmse + 2.0 * 0.0009), 1e-12);
  EXPECT_EQ(planimetry_of(targets, {}).roofs, 0u);
}

}  // namespace
}  // namespace swath::quality
