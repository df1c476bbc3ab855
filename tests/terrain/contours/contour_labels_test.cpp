// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contour_labels.h"

#include <gtest/gtest.h>

namespace swath::terrain {
namespace {

ContourLine circle(double radius, bool depression = false) {
  ContourLine l;
  l.closed = true;
  for (int k = 0; k <= 360; ++k) {
    const double a = core::degree * (depression ? -k : k);
    l.vertices.emplace_back(1000.0 + radius * std::cos(a), 2000.0 + radius * std::sin(a));
  }
  return l;
}

TEST(ContourLabels, OnePerSpacingOnTheLineAndAlongIt) {
  LabelOptions o;
  o.spacing = core::Metres(100.0);
  const ContourLine ring = circle(200.0);
  const auto labels = Labeller(o).add(ring, 3);
  EXPECT_EQ(labels.size(), 12u);  // 1257 m
  for (const ContourLabel& l : labels) {
    const Eigen::Vector2d r = l.at - Eigen::Vector2d(1000.0, 2000.0);
    EXPECT_NEAR(r.norm(), 200.0, 0.01);
    EXPECT_NEAR(std::abs(std::cos(l.angle) * r.x() + std::sin(l.angle) * r.y()), 0.0, 0.5);  // at right angles to the radius
  }
}

TEST(ContourLabels, UphillPutsTheTopOfTheLettersTowardsHigherGround) {
  LabelOptions o;
  o.spacing = core::Metres(50.0);
  o.facing = LabelFacing::uphill;
  for (const bool depression : {false, true}) {
    const auto labels = Labeller(o).add(circle(100.0, depression), 3);
    ASSERT_GT(labels.size(), 6u);
    for (const ContourLabel& l : labels) {
      const Eigen::Vector2d up(-std::sin(l.angle), std::cos(l.angle)), inwards = Eigen::Vector2d(1000.0, 2000.0) - l.at;
      EXPECT_EQ(up.dot(inwards) > 0.0, !depression);
    }
  }
}

TEST(ContourLabels, UprightIsNeverUpsideDown) {
  LabelOptions o;
  o.spacing = core::Metres(20.0);
  for (const bool depression : {false, true})
    for (const ContourLabel& l : Labeller(o).add(circle(100.0, depression), 3)) {
      EXPECT_GT(l.angle, -0.5 * core::pi - 1e-12);
      EXPECT_LE(l.angle, 0.5 * core::pi + 1e-12);
    }
}

TEST(ContourLabels, NoneOnShortOrCurledLinesOrOverAnother) {
  LabelOptions o;
  EXPECT_TRUE(Labeller(o).add(circle(2.0), 3).empty());
  EXPECT_TRUE(Labeller(o).add(circle(3.5), 3).empty());
  Labeller labeller(o);
  const auto first = labeller.add(circle(60.0), 3), second = labeller.add(circle(61.0), 3);
  ASSERT_FALSE(first.empty());
  ASSERT_FALSE(second.empty());
  const double width = 0.7 * 2.0 * 5.0;
  for (const ContourLabel& a : first)
    for (const ContourLabel& b : second) EXPECT_GE((a.at - b.at).norm(), width);
}

TEST(ContourLabels, WideTextsKeepApartToo) {
  LabelOptions o;
  o.height = core::Metres(50.0);
  Labeller labeller(o);
  std::vector<std::pair<Eigen::Vector2d, double>> placed;  // middle, half width
  for (int k = 0; k < 30; ++k) {
    ContourLine line;
    for (int n = 0; n <= 60; ++n) line.vertices.emplace_back(50.0 * n, 2000.0 + 37.0 * k);
    const size_t letters = k % 3 == 0 ? 8 : 2;  // of different widths
    for (const ContourLabel& l : labeller.add(line, letters))
      placed.emplace_back(l.at, 0.5 * 0.7 * 50.0 * static_cast<double>(letters + 2));
  }
  ASSERT_GT(placed.size(), 10u);
  for (size_t a = 0; a < placed.size(); ++a)
    for (size_t b = 0; b < a; ++b)
      EXPECT_GE((placed[a].first - placed[b].first).norm(), placed[a].second + placed[b].second) << a << " " << b;
}

}  // namespace
}  // namespace swath::terrain
