// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "core/ring.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

/// Corners joined by places every 0.3 m with noise across.
Ring rough(const Ring& corners, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-noise, noise);
  Ring out;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector2d side = corners[(k + 1) % corners.size()] - corners[k];
    const int n = static_cast<int>(side.norm() / 0.3);
    for (int i = 0; i < n; ++i) out.push_back(corners[k] + (i + 0.5) / n * side + off(random) * Vector2d(side.y(), -side.x()).normalized());
  }
  return out;
}

Ring turned(const Ring& ring, double angle) {
  Ring out;
  for (const Vector2d& p : ring)
    out.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y());
  return out;
}

const Ring l_shape{{0, 0}, {20, 0}, {20, 8}, {9, 8}, {9, 17}, {0, 17}};

TEST(OutlineShape, CornersOfARectangularBuildingAreFoundAndSquare) {
  for (const double angle : {0.0, 0.3, 0.8, 1.5, 2.9}) {
    const Ring true_ring = turned(l_shape, angle);
    const ShapedRing shaped = shape_ring(rough(true_ring, 0.2, 7), {});
    EXPECT_TRUE(shaped.direction.has_value());
    ASSERT_EQ(shaped.ring.size(), 6u);
    for (const Vector2d& p : true_ring) {
      double least = 1e9;
      for (const Vector2d& q : shaped.ring) least = std::min(least, (p - q).norm());
      EXPECT_LT(least, 0.15);
    }
    for (size_t k = 0; k < 6; ++k) {
      const Vector2d a = shaped.ring[(k + 1) % 6] - shaped.ring[k], b = shaped.ring[(k + 2) % 6] - shaped.ring[(k + 1) % 6];
      EXPECT_NEAR(a.normalized().dot(b.normalized()), 0.0, 1e-9);
    }
  }
}

TEST(OutlineShape, SidesMoveOutwardsOfOutlinesAndIntoCourtyards) {
  // Vertices within 0.25 m of a side: the lines between them have an rms of 0.25 sqrt(2) / 3 m off it, 1.5 times that is 0.177 m.
  ShapeOptions o;
  o.outwards = 0.4;
  const Ring square{{0, 0}, {30, 0}, {30, 30}, {0, 30}}, hole(square.rbegin(), square.rend());
  const double outer = core::signed_area(shape_ring(rough(square, 0.25, 1), o).ring),
               inner = core::signed_area(shape_ring(rough(hole, 0.25, 1), o).ring);
  EXPECT_NEAR(outer, 30.35 * 30.35, 6.0);
  EXPECT_NEAR(inner, -29.65 * 29.65, 6.0);
  o.outwards = 0.1;  // at most
  EXPECT_NEAR(core::signed_area(shape_ring(rough(square, 0.25, 1), o).ring), 30.2 * 30.2, 6.0);
}

TEST(OutlineShape, ARoundBuildingIsNotSquared) {
  Ring circle;
  for (int k = 0; k < 200; ++k) circle.emplace_back(15 * std::cos(k * M_PI / 100), 15 * std::sin(k * M_PI / 100));
  const ShapedRing shaped = shape_ring(circle, {});
  EXPECT_FALSE(shaped.direction.has_value());
  EXPECT_LT(shaped.ring.size(), 40u);
  EXPECT_NEAR(core::signed_area(shaped.ring), M_PI * 225, 0.03 * M_PI * 225);
}

TEST(OutlineShape, NothingMovesFartherThanAllowed) {
  // A notch of 1.4 m by 1.2 m goes with the default movement of 1 m only as far as that allows, and stays with 0.4 m.
  const Ring notched{{0, 0}, {9, 0}, {9, 1.2}, {10.4, 1.2}, {10.4, 0}, {20, 0}, {20, 12}, {0, 12}};
  for (const double movement : {0.4, 1.0, 3.0}) {
    const Ring rim = rough(notched, 0.05, 3);
    ShapeOptions o;
    o.movement = movement;
    const ShapedRing shaped = shape_ring(rim, o);
    for (const Vector2d& p : rim) EXPECT_LE(distance_to(shaped.ring, p), movement + 1e-9);
    EXPECT_EQ(shaped.ring.size(), movement > 2.5 ? 4u : 8u);
  }
}

TEST(OutlineShape, ARingOfTwoPlacesIsNone) {
  EXPECT_TRUE(shape_ring({{0, 0}, {1, 1}}, {}).ring.empty());
  EXPECT_FALSE(is_simple({{0, 0}, {10, 0}, {0, 10}, {10, 10}}));
  EXPECT_TRUE(is_simple(l_shape));
  EXPECT_FALSE(is_simple({{0, 0}, {10, 0}, {10, 5}, {10, 0}, {5, 5}}));  // there and back
}

TEST(Outline, HolesThatMeetTheOutlineOrOneAnotherAreRefused) {
  Outline o{l_shape, {}};
  EXPECT_TRUE(add_hole(o, {{2, 2}, {2, 4}, {4, 4}, {4, 2}}));
  EXPECT_FALSE(add_hole(o, {{7, 7}, {7, 10}, {11, 10}, {11, 7}}));  // its corners lie in it, but for one
  EXPECT_FALSE(add_hole(o, {{3, 3}, {3, 6}, {6, 6}, {6, 3}}));
  EXPECT_FALSE(add_hole(o, {{1, 1}, {1, 5}, {5, 5}, {5, 1}}));  // around the first
  EXPECT_FALSE(add_hole(o, {{12, 10}, {12, 12}, {14, 12}, {14, 10}}));
  EXPECT_TRUE(add_hole(o, {{12, 2}, {12, 4}, {14, 4}, {14, 2}}));
  EXPECT_NEAR(o.area(), 20 * 8 + 9 * 9 - 8, 1e-9);
}

TEST(Rim, OfATriangulationWithAHoleIsTwoRings) {
  core::Block b;
  std::vector<std::uint32_t> rows;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 20; ++j) {
      if (std::abs(i - 10) < 4 && std::abs(j - 10) < 4) continue;
      b.x.push_back(i), b.y.push_back(j), b.z.push_back(5.0);
      rows.push_back(static_cast<std::uint32_t>(rows.size()));
    }
  const Tin tin = triangulate(b, rows, 1.0);
  const std::vector<TrianglePart> parts = parts_of(tin);
  ASSERT_EQ(parts.size(), 1u);
  const Outline rim = rim_of(tin, parts[0], 8.0);
  EXPECT_NEAR(core::signed_area(rim.outer), 400.0, 1e-9);
  ASSERT_EQ(rim.holes.size(), 1u);
  // A triangle fills each of the hole's corners.
  EXPECT_NEAR(core::signed_area(rim.holes[0]), -62.0, 1e-9);
  EXPECT_FALSE(rim.holds({10.2, 10.3}));
  EXPECT_TRUE(rim.holds({2.2, 10.3}));
  EXPECT_TRUE(rim_of(tin, parts[0], 65.0).holes.empty());
}

TEST(Rim, PartsThatTouchAtAVertexAreTakenApart) {
  Tin tin;
  tin.x = {0, 4, 4, -1, -1}, tin.y = {0, 0, 4, 0, -1}, tin.z = {1, 1, 1, 1, 1};
  tin.triangles = {{0, 1, 2}, {3, 4, 0}};
  tin.across = {{-1, -1, -1}, {-1, -1, -1}};
  const Outline rim = rim_of(tin, {0, 1}, 0.1);
  EXPECT_EQ(rim.outer.size(), 3u);
  EXPECT_NEAR(rim.area(), 8.0, 1e-9);
}

}  // namespace
}  // namespace swath::terrain
