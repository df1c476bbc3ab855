// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/edge_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

/// Pulses within 2 m of an edge at `at`, `gap` apart across it in `rows` rows of one random phase each, met with a beam of sigma `beam`.
std::vector<EdgePulse> pulses_at(double at, double gap, int rows, double beam, bool one_phase, std::mt19937& random) {
  std::uniform_real_distribution<double> even(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, beam);
  std::vector<EdgePulse> out;
  double phase = even(random);
  for (int r = 0; r < rows; ++r, phase = one_phase ? phase : even(random))
    for (double d = -2.0 + phase * gap; d < 2.0; d += gap) out.push_back({d, 0.0, d + normal(random) < at});
  return out;
}

/// Rms of error over sigma.
double error_over_sigma(double gap, int rows, double beam, bool one_phase, double* rms = nullptr) {
  std::mt19937 random(static_cast<unsigned>(1000.0 * gap) + static_cast<unsigned>(rows));
  double chi = 0.0, squares = 0.0;
  constexpr int runs = 300;
  for (int k = 0; k < runs; ++k) {
    const double at = 0.3 * std::sin(k);
    const EdgePlace found = edge_places({pulses_at(at, gap, rows, beam, one_phase, random)})[0];
    EXPECT_TRUE(found.is_shown);
    chi += std::pow((found.at - at) / found.sigma, 2) / runs, squares += std::pow(found.at - at, 2) / runs;
  }
  if (rms) *rms = std::sqrt(squares);
  return std::sqrt(chi);
}

// 300 runs: the rms of error over sigma is known to 4 %; three times that.
constexpr double near_one = 0.12;

TEST(EdgePlaces, SigmaIsTrueForManyPulsesAndForFew) {
  EXPECT_NEAR(error_over_sigma(0.35, 25, 0.05, false), 1.0, near_one);
  EXPECT_NEAR(error_over_sigma(0.7, 10, 0.05, false), 1.0, near_one);
  EXPECT_NEAR(error_over_sigma(1.0, 6, 0.1, false), 1.0, near_one);
}

TEST(EdgePlaces, ScanLinesAlongAnEdgeShowItBetweenTwoOfThemOnly) {
  double rms = 0.0;
  EXPECT_NEAR(error_over_sigma(0.7, 20, 0.03, true, &rms), 1.0, near_one);
  EXPECT_NEAR(rms, 0.7 / std::sqrt(12.0), 0.03);
}

TEST(EdgePlaces, NoiseOfTheBeamIsFoundByTheEdgesTogether) {
  std::mt19937 random(5);
  std::vector<std::vector<EdgePulse>> edges;
  for (const double at : {0.1, -0.1, 0.2, 0.0}) edges.push_back(pulses_at(at, 0.3, 40, 0.15, false, random));
  const std::vector<EdgePlace> found = edge_places(edges);
  EXPECT_NEAR(found[0].at, 0.1, 0.06);
  EXPECT_NEAR(found[2].at, 0.2, 0.06);
  EXPECT_NEAR(found[0].sigma, std::sqrt(0.15 * 0.3 / (1.8 * 40.0)), 0.01);
}

TEST(EdgePlaces, StraysMoveItLittle) {
  std::mt19937 random(7);
  std::vector<EdgePulse> pulses = pulses_at(0.2, 0.35, 25, 0.04, false, random);
  for (size_t k = 0; k < pulses.size(); k += 60) pulses[k].hit = !pulses[k].hit;
  EXPECT_NEAR(edge_places({pulses})[0].at, 0.2, 0.05);
}

TEST(EdgePlaces, AWallThatCountsAsRoofIsTakenOff) {
  std::mt19937 random(9);
  std::vector<EdgePulse> pulses = pulses_at(0.25, 0.2, 30, 0.02, false, random);
  for (EdgePulse& p : pulses) p.wall = 0.05;
  EXPECT_NEAR(edge_places({pulses})[0].at, 0.2, 0.02);
}

TEST(EdgePlaces, AnEdgeBeyondTheSearchIsNotShown) {
  std::mt19937 random(11);
  EXPECT_FALSE(edge_places({pulses_at(1.6, 0.35, 25, 0.04, false, random)})[0].is_shown);
  EXPECT_FALSE(edge_places({{}})[0].is_shown);
}

TEST(EdgePlaces, TheRoughPlaceIsBetweenLastHitAndFirstMiss) {
  EXPECT_NEAR(rough_edge({{-1.0, 0.0, true}, {-0.2, 0.0, true}, {0.4, 0.0, false}, {1.0, 0.0, false}}), 0.1, 1e-12);
  EXPECT_NEAR(rough_edge({{0.5, 0.0, true}, {0.1, 0.0, false}, {0.3, 0.0, true}, {-1.0, 0.0, true}, {0.7, 0.0, false}, {0.9, 0.0, false}}),
              0.6, 1e-12);
}

}  // namespace
}  // namespace swath::quality
