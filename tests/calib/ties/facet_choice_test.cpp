// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/facet_choice.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double height = 500.0, speed = 50.0;

/// Two lines along north over the same ground, to and fro, the second 100 s after the first.
ScannerAt flight() {
  return [](double t) -> std::optional<Vector3d> {
    if (t < 0.0 || t > 110.0) return std::nullopt;
    return t < 50.0 ? Vector3d(0.0, speed * t, height) : Vector3d(0.0, speed * (110.0 - t), height);
  };
}

/// Seen by both lines as they pass it.
Facet facet(double east, double north, double slope, double azimuth) {
  Facet f;
  f.centre = {east, north, 0.0};
  f.normal = {std::sin(slope) * std::sin(azimuth), std::sin(slope) * std::cos(azimuth), std::cos(slope)};
  f.half = {4.0, 4.0};
  const double first = north / speed, second = 110.0 - first;
  f.looks = {{0, first - 0.1, first + 0.1, 50}, {1, second - 0.1, second + 0.1, 50}};
  return f;
}

/// Ten seconds of level ground, and four roofs in each that slope along the flight.
std::vector<Facet> block(int level, int sloping) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<Facet> out;
  for (int k = 0; k < level; ++k) out.push_back(facet(360.0 * (u(random) - 0.5), 500.0 * u(random), 0.0, 0.0));
  for (int k = 0; k < sloping; ++k) out.push_back(facet(360.0 * (u(random) - 0.5), 500.0 * u(random), 0.6, k % 2 ? 0.3 : 3.4));
  return out;
}

bool slopes(const Facet& f) { return f.normal.z() < 0.9; }

TEST(FacetChoice, SlopesComeBeforeThousandsOfLevelFacets) {
  core::Tally tally;
  const std::vector<Facet> some = choose_facets(block(3000, 40), flight(), {10.0, 100}, tally);
  // One or two say again what others of their second have said.
  EXPECT_GE(std::count_if(some.begin(), some.end(), slopes), 37);
  EXPECT_LT(some.size(), 300u);
  EXPECT_EQ(tally.of("facets that others make superfluous"), 3040u - some.size());
}

TEST(FacetChoice, EachSecondOfEachLineHasItsNumber) {
  core::Tally tally;
  std::map<std::pair<std::uint32_t, int>, int> count;
  for (const Facet& f : choose_facets(block(3000, 40), flight(), {12.0, 100}, tally))
    for (const FacetLook& l : f.looks) ++count[{l.line, static_cast<int>(std::floor(0.5 * (l.first + l.last)))}];
  EXPECT_EQ(count.size(), 20u);
  for (const auto& [at, n] : count) {
    EXPECT_GE(n, 12) << "line " << at.first << ", second " << at.second;
    EXPECT_LE(n, 14) << "line " << at.first << ", second " << at.second;  // the other line's second had room
  }
}

// Level ground determines height and roll: the choice takes it from both edges of the swath.
TEST(FacetChoice, LevelFacetsAreTakenWhereTheyTurnTheBodyMost) {
  core::Tally tally;
  double farthest = 0.0, all = 0.0;
  const std::vector<Facet> given = block(3000, 0);
  const std::vector<Facet> some = choose_facets(given, flight(), {6.0, 100}, tally);
  int left = 0, right = 0;
  for (const Facet& f : some) farthest += std::abs(f.centre.x()) / static_cast<double>(some.size()), ++(f.centre.x() < 0 ? left : right);
  for (const Facet& f : given) all += std::abs(f.centre.x()) / static_cast<double>(given.size());
  std::printf("mean distance from nadir: %.0f m of those taken, %.0f m of all\n", farthest, all);
  EXPECT_GT(farthest, 1.5 * all);
  EXPECT_GT(left, 20);
  EXPECT_GT(right, 20);
}

TEST(FacetChoice, WithoutANumberAllStayInTheirOrder) {
  core::Tally tally;
  const std::vector<Facet> given = block(20, 5);
  const std::vector<Facet> some = choose_facets(given, flight(), {std::nullopt, 100}, tally);
  ASSERT_EQ(some.size(), given.size());
  for (size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k].centre, given[k].centre);
}

TEST(FacetChoice, WhatTheTrajectoryDoesNotReachIsNotTaken) {
  core::Tally tally;
  std::vector<Facet> given = block(0, 3);
  for (FacetLook& l : given[1].looks) l.first += 1000.0, l.last += 1000.0;
  const std::vector<Facet> some = choose_facets(given, flight(), {10.0, 100}, tally);
  ASSERT_EQ(some.size(), 2u);
  EXPECT_EQ(some[1].centre, given[2].centre);
}

}  // namespace
}  // namespace swath::calib
