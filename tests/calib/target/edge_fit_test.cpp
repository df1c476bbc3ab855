// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/edge_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/navigation.h"

namespace swath::calib {
namespace {

using swath::test::Dice;

// Pulses of scan lines across an edge at s = offset + slope t.
std::vector<EdgePulse> shoot(Dice& dice, double spacing, double along, double blur, double half, double offset, double slope) {
  std::vector<EdgePulse> out;
  for (double t = -25.0; t < 25.0; t += along) {
    const double start = -2.0 + spacing * dice.uniform();
    for (double s = start; s < 2.0; s += spacing) {
      const double inward = offset + slope * t - (s + blur * dice.normal());
      out.push_back({static_cast<float>(s), static_cast<float>(t),
                     inward > half    ? EdgePulse::on
                     : inward > -half ? EdgePulse::both
                                      : EdgePulse::off});
    }
  }
  return out;
}

struct Score {
  double rms = 0.0, ratio = 0.0, sigma = 0.0;
};

Score over_seeds(double spacing, double along, double blur, double half, const EdgePrior& prior) {
  Score out;
  constexpr int seeds = 60;
  for (int seed = 1; seed <= seeds; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    const double offset = 0.4 * (dice.uniform() - 0.5), slope = 0.01 * dice.normal();
    const SideView v = locate_edge(shoot(dice, spacing, along, blur, half, offset, slope), prior);
    EXPECT_TRUE(v.used);
    const double error = v.offset - offset - slope * v.at, sigma = std::sqrt(v.covariance(0, 0));
    out.rms += error * error / seeds;
    out.ratio += error * error / (sigma * sigma) / seeds;
    out.sigma += sigma / seeds;
  }
  out.rms = std::sqrt(out.rms);
  out.ratio = std::sqrt(out.ratio);
  return out;
}

// Error / sigma over sixty seeds: sqrt(chi2 / 60) lies within 0.82 and 1.18 in 95 of 100 cases.
constexpr double lowest_ratio = 0.78, highest_ratio = 1.25;

TEST(EdgeFit, IsFarBetterThanTheSpacing) {
  const Score s = over_seeds(0.8, 0.8, 0.05, 0.0, {0.05, 0.0, 1.5, 0.01});
  EXPECT_LT(s.rms, 0.03);
  EXPECT_GT(s.ratio, lowest_ratio);
  EXPECT_LT(s.ratio, highest_ratio);
}

TEST(EdgeFit, MixedReturnsTellTheMiddle) {
  const Score s = over_seeds(0.6, 0.9, 0.04, 0.22, {0.04, 0.22, 1.5, 0.01});
  EXPECT_LT(s.rms, 0.03);
  EXPECT_GT(s.ratio, lowest_ratio);
  EXPECT_LT(s.ratio, highest_ratio);
}

TEST(EdgeFit, AFacingWallLeavesTheOuterEnd) {
  Dice dice(3);
  auto pulses = shoot(dice, 0.6, 0.6, 0.04, 0.22, 0.15, 0.0);
  for (EdgePulse& p : pulses)
    if (p.outcome != EdgePulse::off) p.outcome = EdgePulse::first_on;
  const SideView v = locate_edge(pulses, {0.04, 0.22, 1.5, 0.01});
  EXPECT_NEAR(v.offset, 0.15, 4.0 * std::sqrt(v.covariance(0, 0)));
  EXPECT_LT(std::sqrt(v.covariance(0, 0)), 0.03);
}

TEST(EdgeFit, WithoutBlurTheStepLiesBetweenNeighbours) {
  const Score s = over_seeds(1.0, 1.0, 0.0, 0.0, {0.01, 0.0, 1.5, 0.01});
  EXPECT_LT(s.rms, 0.03);
  EXPECT_GT(s.ratio, lowest_ratio);
  EXPECT_LT(s.ratio, highest_ratio);
}

TEST(EdgeFit, AGapAlongTheWholeEdgeIsNotFilledWithConfidence) {
  // Scan lines parallel to the edge, 0.9 m apart: it lies anywhere between two of them.
  double squares = 0.0;
  constexpr int seeds = 40;
  for (int seed = 1; seed <= seeds; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    const double offset = 0.9 * (dice.uniform() - 0.5);
    std::vector<EdgePulse> pulses;
    for (double s = -2.25; s < 2.3; s += 0.9)
      for (double t = -20.0; t < 20.0; t += 0.5)
        pulses.push_back(
            {static_cast<float>(s), static_cast<float>(t), s + 0.03 * dice.normal() < offset ? EdgePulse::on : EdgePulse::off});
    const SideView v = locate_edge(pulses, {0.03, 0.0, 2.0, 1e-3});
    const double sigma = std::sqrt(v.covariance(0, 0));
    // A uniform distribution over 0.9 m has 0.26 m; an edge on a scan line is known by the blur.
    const double to_line = 0.45 - std::abs(offset);
    if (to_line > 0.1) {
      EXPECT_GT(sigma, 0.1);
    }
    EXPECT_LT(sigma, 0.35);
    squares += std::pow((v.offset - offset) / sigma, 2) / seeds;
  }
  EXPECT_LT(std::sqrt(squares), highest_ratio);
}

TEST(EdgeFit, OutliersDoNotMoveIt) {
  Dice dice(5);
  auto pulses = shoot(dice, 0.8, 0.8, 0.05, 0.0, 0.1, 0.0);
  const SideView clean = locate_edge(pulses, {0.05, 0.0, 1.5, 0.01});
  for (size_t i = 0; i < pulses.size(); i += 60) pulses[i].outcome = pulses[i].outcome == EdgePulse::on ? EdgePulse::off : EdgePulse::on;
  const SideView v = locate_edge(pulses, {0.05, 0.0, 1.5, 0.01});
  EXPECT_NEAR(v.offset, clean.offset, 3.0 * std::sqrt(clean.covariance(0, 0)));
}

TEST(EdgeFit, WithoutAnEdgeNothingIsSaid) {
  Dice dice(6);
  auto pulses = shoot(dice, 0.8, 0.8, 0.05, 0.0, 0.1, 0.0);
  EXPECT_FALSE(locate_edge({}, {0.05, 0.0, 1.5, 0.01}).used);
  for (EdgePulse& p : pulses) p.outcome = EdgePulse::on;
  EXPECT_FALSE(locate_edge(pulses, {0.05, 0.0, 1.5, 0.01}).used);
  // Beyond the reach.
  pulses = shoot(dice, 0.8, 0.8, 0.05, 0.0, 1.9, 0.0);
  EXPECT_FALSE(locate_edge(pulses, {0.05, 0.0, 1.0, 0.01}).used);
}

TEST(EdgeFit, ShapeOfTheEdge) {
  Dice dice(7);
  const auto pulses = shoot(dice, 0.3, 0.3, 0.06, 0.2, 0.0, 0.0);
  const EdgeShape s = edge_shape(pulses, 0.05, 0.5);
  EXPECT_NEAR(s.half, 0.2, 0.025);
  EXPECT_NEAR(s.blur, 0.06, 0.02);
  EXPECT_EQ(edge_shape(pulses, 0.05, 0.0).half, 0.0);
}

}  // namespace
}  // namespace swath::calib
