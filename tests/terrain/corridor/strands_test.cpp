// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/strands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/world/power_line.h"

namespace swath::terrain {
namespace {

std::vector<WirePoint> wire_points(const test::PowerLineScene& s) {
  std::vector<WirePoint> out;
  for (size_t p = 0; p < s.block.size(); ++p)
    if (s.truth[p] == core::point_class::wire) out.push_back({s.block.x[p], s.block.y[p], s.block.z[p], s.block.strip[p]});
  return out;
}

TEST(Strands, EachWireOfEachSpanIsOneWithoutAnyKnowledgeOfSupports) {
  const test::PowerLineScene s = test::make_power_line({});
  const std::vector<WirePoint> points = wire_points(s);
  const std::vector<Strand> strands = find_strands(points, {});
  ASSERT_GE(strands.size(), s.wires.size());
  EXPECT_LE(strands.size(), s.wires.size() + 1);  // where no support is known, returns beside it may be left as a short strand
  size_t used = 0;
  for (const Strand& strand : strands) used += strand.points.size();
  EXPECT_GE(static_cast<double>(used), 0.97 * static_cast<double>(points.size()));
  for (const test::TrueWire& w : s.wires) {
    const auto is_it = [&](const Strand& strand) {
      const Eigen::Vector3d m = w.at(0.5 * w.length);
      const double at = strand.line.s(m.head<2>());
      return at > strand.first && at < strand.last && std::abs(strand.line.v(m.head<2>())) < 0.1 &&
             std::abs(strand.fit.curve.z(at) - m.z()) < 0.03;
    };
    EXPECT_EQ(std::count_if(strands.begin(), strands.end(), is_it), 1);
  }
}

TEST(Strands, DoNotDependOnTheOrderOfTheReturns) {
  std::vector<WirePoint> points = wire_points(test::make_power_line({}));
  const std::vector<Strand> strands = find_strands(points, {});
  std::shuffle(points.begin(), points.end(), std::mt19937(3));
  const std::vector<Strand> again = find_strands(points, {});
  ASSERT_EQ(again.size(), strands.size());
  for (size_t k = 0; k < strands.size(); ++k) {
    EXPECT_EQ(again[k].points.size(), strands[k].points.size());
    EXPECT_NEAR(again[k].fit.curve.kappa, strands[k].fit.curve.kappa, 1e-9);
  }
}

TEST(Strands, AStretchWithoutReturnsIsBridgedUnlessASupportLiesInIt) {
  std::vector<WirePoint> points;
  for (double s = 0.0; s < 160.0; s += 0.5)
    if (s < 60.0 || s > 95.0)
      points.push_back({s, 0.02 * std::sin(9 * s), 20.0 + std::pow(s - 80.0, 2) / 1400.0 + 0.02 * std::cos(7 * s), 1});
  EXPECT_EQ(find_strands(points, {}).size(), 1u);
  EXPECT_EQ(find_strands(points, {{78.0, 1.0}}).size(), 2u);
}

TEST(Strands, WhatHangsUpwardsIsShortOrScatteredIsNone) {
  std::vector<WirePoint> arch, brief, cloud;
  for (double s = 0.0; s < 80.0; s += 0.5) arch.push_back({s, 0.0, 20.0 - std::pow(s - 40.0, 2) / 200.0 + 0.02 * std::sin(9 * s), 1});
  for (double s = 0.0; s < 12.0; s += 0.5) brief.push_back({s, 0.0, 20.0, 1});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, 40.0);
  for (int k = 0; k < 400; ++k) cloud.push_back({place(random), place(random), 10.0 + place(random), 1});
  EXPECT_TRUE(find_strands(arch, {}).empty());
  EXPECT_TRUE(find_strands(brief, {}).empty());
  EXPECT_TRUE(find_strands(cloud, {}).empty());
  EXPECT_TRUE(find_strands({}, {}).empty());
}

}  // namespace
}  // namespace swath::terrain
