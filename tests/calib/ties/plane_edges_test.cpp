// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/plane_edges.h"

#include <gtest/gtest.h>

#include <random>

namespace swath::calib {
namespace {

using Eigen::Vector2d;

/// Four points per square metre over 10 m by 6 m, without a hole of 2 m.
std::vector<Vector2d> with_a_hole() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u;
  std::vector<Vector2d> out;
  for (int i = 0; i < 240; ++i) {
    const Vector2d p(10 * u(random), 6 * u(random));
    if (p.x() < 4 || p.x() > 6 || p.y() < 2 || p.y() > 4) out.push_back(p);
  }
  return out;
}

TEST(PlaneEdges, WithinAMarginOfAnEdgeNothingIsSurrounded) {
  const Occupied o(with_a_hole(), 1.0);
  constexpr double margin = 0.5;
  int inner = 0, seen = 0;
  for (double x = -0.45; x < 10.5; x += 0.1)
    for (double y = -0.45; y < 6.5; y += 0.1) {
      const Vector2d p(x, y);
      const bool out = x < margin || y < margin || x > 10 - margin || y > 6 - margin;
      if (out) {
        EXPECT_FALSE(o.surrounds(p, margin + 1e-9)) << p.transpose();
      }
      const bool hole = x > 4.1 && x < 5.9 && y > 2.1 && y < 3.9;
      if (hole) {
        EXPECT_FALSE(o.surrounds(p, margin));
      }
      if (x > 1.6 && x < 2.4 && y > 1.6 && y < 4.4) ++inner, seen += o.surrounds(p, margin);
    }
  EXPECT_EQ(seen, inner) << "a square that is empty by chance is no edge";
}

TEST(PlaneEdges, ALonePointSurroundsNothing) {
  const Occupied o({{0.5, 0.5}}, 1.0);
  EXPECT_FALSE(o.surrounds({0.5, 0.5}, 0.6));
  EXPECT_TRUE(o.surrounds({0.5, 0.5}, 0.0));
}

}  // namespace
}  // namespace swath::calib
