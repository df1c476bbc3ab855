// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/roof_planimetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

RoofShift roof(const std::string& name, double east, double north, double sigma) {
  RoofShift s;
  s.name = name, s.state = RoofState::both, s.edges = 4;
  s.shift = {east, north}, s.information = Matrix2d::Identity() / (sigma * sigma);
  return s;
}

TEST(RoofPlanimetry, RmseByHandWithTheTargetsError) {
  std::vector<RoofShift> shifts{roof("a", 0.05, 0.0, 0.02), roof("b", 0.03, 0.04, 0.02), roof("c", -0.02, 0.02, 0.02)};
  for (RoofShift& s : shifts) s.target_sigma = 0.01;
  std::vector<NamedFault> named;
  const RoofPlanimetry p = planimetry_of(shifts, named);
  EXPECT_EQ(p.roofs, 3u);
  EXPECT_TRUE(named.empty());
  EXPECT_NEAR(*p.rmse_east, std::sqrt((0.0025 + 0.0009 + 0.0004) / 3.0), 1e-12);
  EXPECT_NEAR(*p.rmse_north, std::sqrt((0.0016 + 0.0004) / 3.0), 1e-12);
  EXPECT_NEAR(*p.rmse, std::sqrt((0.0038 + 0.0020) / 3.0), 1e-12);
  EXPECT_NEAR(p.target_sigma, 0.01 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(p.measured_sigma, std::sqrt(2.0 * (0.0004 - 0.0001)), 1e-12);
  EXPECT_NEAR(*p.with_targets, std::sqrt(0.0058 / 3.0 + 0.0002), 1e-12);
  EXPECT_NEAR(p.cloud, std::sqrt(0.0058 / 3.0 - 0.0008), 1e-12);
  EXPECT_NEAR(*p.nssda, 2.4477 * 0.5 * (std::sqrt(0.0038 / 3.0 + 0.0001) + std::sqrt(0.002 / 3.0 + 0.0001)), 1e-12);
  EXPECT_FALSE(p.is_enough);
}

TEST(RoofPlanimetry, TwoRoofsGiveAMeanAndNoRmse) {
  std::vector<RoofShift> shifts{roof("a", 0.04, 0.0, 0.01), roof("b", 0.04, 0.0, 0.02)};
  std::vector<NamedFault> named;
  const RoofPlanimetry p = planimetry_of(shifts, named);
  EXPECT_NEAR(*p.east, 0.04, 1e-9);
  EXPECT_NEAR(*p.sigma_east, 1.0 / std::sqrt(1.0 / 0.0001 + 1.0 / 0.0004), 1e-9);
  EXPECT_FALSE(p.rmse);
}

TEST(RoofPlanimetry, SigmaOfTheMeanIsTrueWithAndWithoutScatterBetweenRoofs) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (const double between : {0.0, 0.05}) {
    constexpr int runs = 400, roofs = 15;
    double chi = 0.0;
    for (int k = 0; k < runs; ++k) {
      std::vector<RoofShift> shifts;
      for (int r = 0; r < roofs; ++r) {
        const double sigma = 0.02 + 0.002 * r, all = std::hypot(sigma, between);
        shifts.push_back(roof(std::to_string(r), 0.1 + all * normal(random), -0.05 + all * normal(random), sigma));
      }
      std::vector<NamedFault> named;
      const RoofPlanimetry p = planimetry_of(shifts, named);
      EXPECT_EQ(p.roofs + p.changed, 15u);
      chi += std::pow((*p.east - 0.1) / *p.sigma_east, 2) + std::pow((*p.north + 0.05) / *p.sigma_north, 2);
    }
    EXPECT_NEAR(std::sqrt(chi / (2.0 * runs)), 1.0, 0.12) << between;  // a scatter known from 15 roofs alone makes 1.04
  }
}

TEST(RoofPlanimetry, AChangedRoofIsNamedAndCountsInNoFigure) {
  std::vector<RoofShift> shifts;
  for (int k = 0; k < 8; ++k) shifts.push_back(roof("roof " + std::to_string(k), 0.05 + 0.01 * (k % 3), -0.02 * (k % 2), 0.02));
  shifts.push_back(roof("moved", 0.60, 0.0, 0.02));
  shifts.push_back(roof("vague", 0.30, 0.0, 0.15));
  std::vector<NamedFault> named;
  const RoofPlanimetry p = planimetry_of(shifts, named);
  ASSERT_EQ(named.size(), 1u);
  EXPECT_EQ(named[0].code, "check.roof");
  EXPECT_NE(named[0].sentence.find("roof moved lies 0.5"), std::string::npos) << named[0].sentence;
  EXPECT_EQ(p.changed, 1u);
  EXPECT_EQ(p.roofs, 9u);
  EXPECT_NEAR(*p.east, 0.06, 0.02);
  EXPECT_EQ(shifts[8].state, RoofState::disagrees);
}

TEST(RoofPlanimetry, OneComponentAloneIsSaid) {
  const Vector2d best = Vector2d(1.0, 1.0).normalized();
  std::vector<RoofShift> shifts;
  for (const double along : {0.10, 0.14}) {
    RoofShift s = roof("a", along * best.x(), along * best.y(), 0.02);
    s.state = RoofState::one, s.information = best * best.transpose() / 0.0004;
    shifts.push_back(s);
  }
  std::vector<NamedFault> named;
  RoofPlanimetry p = planimetry_of(shifts, named);
  EXPECT_FALSE(p.east || p.north || p.rmse);
  EXPECT_EQ(p.one_component, 2u);
  EXPECT_NEAR(*p.azimuth, 45.0, 1e-9);
  EXPECT_NEAR(*p.along, 0.12, 1e-9);
  EXPECT_NEAR(*p.sigma_along, 0.02 / std::sqrt(2.0), 0.01);
  for (const double along : {0.5, -0.5}) shifts[along > 0.0 ? 0 : 1].shift = along * best;  // two of one unknown do not fit
  EXPECT_NEAR(planimetry_of(shifts, named).between, 0.7, 0.02);
  for (const double along : {0.10, 0.14}) shifts[along < 0.12 ? 0 : 1].shift = along * best;
  // A roof of the other component completes it.
  const Vector2d other(-best.y(), best.x());
  RoofShift s = shifts[0];
  s.shift = 0.3 * other, s.information = other * other.transpose() / 0.0004;
  shifts.push_back(s);
  p = planimetry_of(shifts, named);
  ASSERT_TRUE(p.east && p.north);
  EXPECT_NEAR(Vector2d(*p.east, *p.north).dot(other), 0.3, 1e-9);
  EXPECT_NEAR(Vector2d(*p.east, *p.north).dot(best), 0.12, 1e-9);
}

TEST(RoofPlanimetry, NothingKnownGivesCountsAlone) {
  RoofShift few, gone;
  few.state = RoofState::few_edges, gone.state = RoofState::not_there;
  std::vector<RoofShift> shifts{few, gone};
  std::vector<NamedFault> named;
  const RoofPlanimetry p = planimetry_of(shifts, named);
  EXPECT_EQ(p.few_edges + p.not_there, 2u);
  EXPECT_FALSE(p.east || p.along || p.rmse);
}

}  // namespace
}  // namespace swath::quality
