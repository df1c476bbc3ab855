// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/roof_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

constexpr double tolerance = 0.15, area = 9.0;

/// Share of the scene's returns of one class that lie on planes.
double planar_share(const test::Scene& s, std::uint8_t kind, Planar least = Planar::some) {
  std::vector<std::uint8_t> candidate(s.block.size());
  for (size_t p = 0; p < candidate.size(); ++p) candidate[p] = s.truth[p] != core::point_class::ground;
  const std::vector<Planar> planar = planar_points(s.block, candidate, districts(s.block), tolerance, area);
  double all = 0, found = 0;
  for (size_t p = 0; p < candidate.size(); ++p) {
    EXPECT_TRUE(planar[p] == Planar::none || candidate[p]);
    if (s.truth[p] == kind) ++all, found += planar[p] >= least;
  }
  EXPECT_GT(all, 0);
  return found / all;
}

TEST(RoofPlanes, RoofsAndDecksArePlanesAndCrownsAreNot) {
  constexpr double nearly_all = 0.97, nearly_none = 0.01;
  EXPECT_GE(planar_share(test::make_scene("town"), core::point_class::building), nearly_all);
  EXPECT_GE(planar_share(test::make_scene("bridge"), core::point_class::bridge_deck), nearly_all);
  EXPECT_GE(planar_share(test::make_scene("town"), core::point_class::building, Planar::wide), 0.9);
  EXPECT_LE(planar_share(test::make_scene("forest"), core::point_class::high_vegetation), nearly_none);
}

/// Pulses `spacing` apart that return from a level plane, off it by up to `rough`, and from the floor below it.
std::vector<Planar> on_glass(double rough) {
  constexpr double spacing = 0.3;
  core::Block b;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i)
      for (const bool first : {true, false}) {
        const double off = rough * std::sin(12.9 * i + 78.2 * j);
        test::add_point(b, 50.0 + spacing * i, 50.0 + spacing * j, first ? 20.0 + off : 17.0);
      }
  b.return_count.assign(b.size(), 2);
  for (size_t p = 0; p < b.size(); ++p) b.return_number.push_back(p % 2 == 0 ? 1 : 2);
  std::vector<std::uint8_t> candidate(b.size());
  for (size_t p = 0; p < b.size(); ++p) candidate[p] = b.z[p] > 18.0;
  return planar_points(b, candidate, districts(b), tolerance, area);
}

TEST(RoofPlanes, APlaneThatBeamsPassIsARoofIfItIsAsSmoothAsGlass) {
  const std::vector<Planar> glass = on_glass(0.02), leaves = on_glass(0.1);
  EXPECT_GT(std::count(glass.begin(), glass.end(), Planar::wide), 800);
  EXPECT_EQ(std::count(leaves.begin(), leaves.end(), Planar::wide), 0);
}

/// Returns on a dome, `spacing` apart.
std::vector<Planar> on_dome(double radius, double spacing) {
  core::Block b;
  const double half = 0.7 * radius;
  for (double y = -half; y < half; y += spacing)
    for (double x = -half; x < half; x += spacing)
      test::add_point(b, 50.0 + x, 50.0 + y, 20.0 + std::sqrt(radius * radius - x * x - y * y));
  return planar_points(b, std::vector<std::uint8_t>(b.size(), 1), districts(b), tolerance, area);
}

TEST(RoofPlanes, ASmoothCrownHasNoWidePlane) {
  const std::vector<Planar> crown = on_dome(4.0, 0.25), gasometer = on_dome(60.0, 0.5);
  EXPECT_EQ(std::count(crown.begin(), crown.end(), Planar::wide), 0);
  EXPECT_GT(static_cast<double>(std::count(gasometer.begin(), gasometer.end(), Planar::wide)), 0.9 * static_cast<double>(gasometer.size()));
}

TEST(RoofPlanes, ThinReturnsShowRoofsInWiderWindows) {
  test::Scene s = test::make_scene("town");
  std::vector<std::uint32_t> rows;
  for (std::uint32_t p = 0; p < s.block.size(); p += 4) rows.push_back(p);  // one return on 4 m2
  test::Scene thin = s;
  thin.block = core::select(s.block, rows);
  thin.truth.clear();
  for (const std::uint32_t p : rows) thin.truth.push_back(s.truth[p]);
  EXPECT_GE(planar_share(thin, core::point_class::building), 0.75);
}

TEST(RoofPlanes, DoNotDependOnTheOrderOrOnWhatIsFar) {
  const test::Scene s = test::make_scene("town");
  const auto planes = [](const core::Block& b) {
    return planar_points(b, std::vector<std::uint8_t>(b.size(), 1), districts(b), tolerance, area);
  };
  const std::vector<Planar> whole = planes(s.block);
  std::vector<std::uint32_t> rows;
  const std::vector<Planar> again = planes(test::shuffled(s.block, 3, rows));
  for (size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(again[k], whole[rows[k]]);
  rows.clear();
  for (std::uint32_t p = 0; p < s.block.size(); ++p)
    if (std::abs(s.block.x[p] - 100.0) <= planar_points_halo() + 5.0) rows.push_back(p);
  ASSERT_LT(rows.size(), s.block.size());
  const core::Block part = core::select(s.block, rows);
  const std::vector<Planar> local = planes(part);
  for (size_t k = 0; k < rows.size(); ++k)
    if (std::abs(part.x[k] - 100.0) <= 5.0) {
      EXPECT_EQ(local[k], whole[rows[k]]) << k;
    }
}

TEST(RoofPlanes, NoPointsNoPlanes) { EXPECT_TRUE(planar_points({}, {}, {}, tolerance, area).empty()); }

}  // namespace
}  // namespace swath::filters
