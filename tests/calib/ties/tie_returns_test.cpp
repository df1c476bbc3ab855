// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_returns.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(TieReturns, InsideAPolygonAndAwayFromItsEdges) {
  const std::vector<Vector2d> angle{{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}};
  EXPECT_TRUE(is_inside(angle, {2, 8}, 1.0));
  EXPECT_TRUE(is_inside(angle, {8, 2}, 1.0));
  EXPECT_FALSE(is_inside(angle, {8, 8}, 0.0));
  EXPECT_FALSE(is_inside(angle, {8, 0.5}, 1.0));
  EXPECT_FALSE(is_inside(angle, {4.5, 4.5}, 0.0));
  EXPECT_FALSE(is_inside(angle, {3.8, 4.2}, 0.5)) << "the inner corner is an edge too";
  EXPECT_FALSE(is_inside(angle, {-1, 2}, 0.0));
}

struct OneHouse {
  test::TieWorld world;
  test::Flown flown;
  std::optional<trajectory::Trajectory> flight;
  std::vector<TieLine> lines{{1, 0.0, 0.0}, {2, 0.0, 0.0}};

  OneHouse() {
    world.houses = {test::gable({0, 0}, 0.3, 15, 8, 0.0, 6.0, 11.0)};
    world.prf = 20000.0;
    flown = test::fly(world, {{{0, 0}, 300, 0.3, 100}, {{0, 0}, 300, 0.3 + core::pi, 100}}, 3);
    flight.emplace(flown.data);
  }
  PlaneRegion roof() const {
    PlaneRegion r;
    const Eigen::Vector4d& q = world.houses[0].planes[4];
    r.normal = q.head<3>();
    r.centre = {0.0, 0.0, 11.0};
    r.centre += 4.0 * Vector3d(r.normal.x(), r.normal.y(), 0.0).normalized();
    r.centre -= r.normal * (r.normal.dot(r.centre) - q[3]);
    r.reach = 0.3;
    r.outline = {{-14, -3}, {14, -3}, {14, 3}, {-14, 3}};
    r.margin = 0.5;
    r.wanted = 100000;
    r.looks = {{0, 0.0, 0.0, 100}};
    return r;
  }
};

TEST(TieReturns, AllReturnsWithinTheRegionAndNoneElse) {
  const OneHouse w;
  LocalPoints points(w.world.scanner, w.world.truth, *w.flight, w.world.frame);
  const PlaneRegion r = w.roof();
  const auto near = collect_returns(w.flown.stream(999), points, {r}, 2.0, w.lines);
  ASSERT_EQ(near.size(), 1u);
  // By hand.
  const auto axes = plane_axes(r.normal);
  size_t expected = 0;
  for (const auto& [id, shots] : w.flown.lines) {
    PointColumns p;
    points.run(shots, p);
    for (size_t i = 0; i < shots.size(); ++i) {
      const Vector3d away = Vector3d(p.x[i], p.y[i], p.z[i]) - r.centre;
      expected += std::abs(r.normal.dot(away)) <= r.reach && std::abs(axes[0].dot(away)) < 13.5 && std::abs(axes[1].dot(away)) < 2.5;
    }
  }
  EXPECT_GT(expected, 200u);
  EXPECT_EQ(near[0].size(), expected);
  for (const NearReturn& x : near[0]) EXPECT_LT(std::abs(r.normal.dot(x.place.cast<double>())), r.reach + 1e-5);
}

TEST(TieReturns, CellsOfAFacetGiveTheSamePlane) {
  const OneHouse w;
  LocalPoints points(w.world.scanner, w.world.truth, *w.flight, w.world.frame);
  PlaneRegion r = w.roof();
  // Cells over the middle of the roof.
  const auto axes = plane_axes(r.normal);
  for (double u = -8; u <= 8; u += 0.5)
    for (double v = -1.5; v <= 1.5; v += 0.5) {
      const Vector3d p = r.centre + u * axes[0] + v * axes[1];
      r.cells.push_back(cell_of(p.x(), p.y(), p.z(), 2.0));
    }
  r.outline.clear();
  const auto near = collect_returns(w.flown.stream(), points, {r}, 2.0, w.lines);
  EXPECT_GT(near[0].size(), 100u);
  for (const NearReturn& x : near[0]) EXPECT_LT(std::abs(r.normal.dot(x.place.cast<double>())), r.reach + 1e-5);
}

TEST(TieReturns, OfManyAnEvenShareIsKept) {
  const OneHouse w;
  LocalPoints points(w.world.scanner, w.world.truth, *w.flight, w.world.frame);
  PlaneRegion r = w.roof();
  const size_t all = collect_returns(w.flown.stream(), points, {r}, 2.0, w.lines)[0].size();
  r.wanted = 40;
  r.looks = {{0, 0.0, 0.0, static_cast<std::uint32_t>(all / 2)}, {1, 0.0, 0.0, static_cast<std::uint32_t>(all / 2)}};
  const auto some = collect_returns(w.flown.stream(), points, {r}, 2.0, w.lines)[0];
  const double expected = 2 * 1.5 * 40;
  EXPECT_NEAR(static_cast<double>(some.size()), expected, 4.0 * std::sqrt(expected));
  Vector3d mean = Vector3d::Zero();
  for (const NearReturn& x : some) mean += x.place.cast<double>() / static_cast<double>(some.size());
  const auto axes = plane_axes(r.normal);
  EXPECT_LT(std::abs(axes[0].dot(mean)), 4.0 * 8.0 / std::sqrt(expected)) << "spread over the whole roof";
}

}  // namespace
}  // namespace swath::calib
