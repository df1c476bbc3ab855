// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/least_bending.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

constexpr core::Lattice cells{2.0, 100, 200, 40, 30};
constexpr size_t plenty = 100000;

/// Cells within `radius` cells of the middle.
std::vector<std::uint8_t> disc(double radius) {
  std::vector<std::uint8_t> open(cells.size(), 0);
  for (int j = 0; j < cells.ny; ++j)
    for (int i = 0; i < cells.nx; ++i) open[cells.at(i, j)] = std::hypot(i - 20, j - 15) <= radius;
  return open;
}

core::Grid with_hole(const test::Surface& f, const std::vector<std::uint8_t>& open) {
  core::Grid g = test::sampled(cells, f);
  for (size_t c = 0; c < open.size(); ++c)
    if (open[c]) g.height[c] = 0.0f;
  return g;
}

TEST(LeastBending, APlaneGoesOnAndABowlCloses) {
  const test::Surface plane = [](double x, double y) { return 5.0 + 0.1 * x - 0.05 * y; };
  const std::vector<std::uint8_t> open = disc(8.0);
  std::vector<std::uint8_t> filled;
  core::Grid g = with_hole(plane, open);
  const FilledParts found = fill_by_least_bending(g, open, {}, plenty, filled);
  EXPECT_EQ(found.parts, 1u);
  EXPECT_EQ(filled, open);
  const core::Grid truth = test::sampled(cells, plane);
  for (size_t c = 0; c < open.size(); ++c) EXPECT_NEAR(g.height[c], truth.height[c], 2e-3);

  // A dome of 30 m radius: its top is 5 m above the hole's rim, and the fill finds all but a tenth of it.
  const double cx = cells.centre_x(20), cy = cells.centre_y(15);
  const test::Surface dome = [&](double x, double y) { return -0.02 * ((x - cx) * (x - cx) + (y - cy) * (y - cy)); };
  g = with_hole(dome, open);
  fill_by_least_bending(g, open, {}, plenty, filled);
  EXPECT_NEAR(g.height[cells.at(20, 15)], 0.0, 0.5);
}

TEST(LeastBending, KnownHeightsHoldAndLargePartsStay) {
  const std::vector<std::uint8_t> open = disc(8.0);
  std::vector<std::uint8_t> filled;
  core::Grid g = with_hole([](double, double) { return 10.0; }, open);
  const Eigen::Vector3d top(cells.centre_x(20) + 0.3, cells.centre_y(15) - 0.4, 13.0);
  fill_by_least_bending(g, open, {top}, plenty, filled);
  EXPECT_NEAR(g.height[cells.at(20, 15)], 13.0, 0.1);
  g = with_hole([](double, double) { return 10.0; }, open);
  const FilledParts left = fill_by_least_bending(g, open, {}, 50, filled);
  EXPECT_EQ(left.parts, 0u);
  EXPECT_EQ(left.parts_left, 1u);
  EXPECT_EQ(g.height[cells.at(20, 15)], 0.0f);
}

TEST(LeastBending, VoidsStayOutAndPartsApartAreSolvedApart) {
  const test::Surface plane = [](double x, double) { return 0.1 * x; };
  std::vector<std::uint8_t> open(cells.size(), 0), filled;
  for (const int i : {5, 6, 30}) open[cells.at(i, 10)] = 1;
  core::Grid g = with_hole(plane, open);
  g.height[cells.at(30, 11)] = std::nanf("");
  open[cells.at(30, 11)] = 1;  // without a height: stays void
  const FilledParts found = fill_by_least_bending(g, open, {}, plenty, filled);
  EXPECT_EQ(found.parts, 2u);
  EXPECT_EQ(found.cells, 3u);
  EXPECT_TRUE(std::isnan(g.height[cells.at(30, 11)]));
  const core::Grid truth = test::sampled(cells, plane);
  for (const int i : {5, 6, 30}) EXPECT_NEAR(g.height[cells.at(i, 10)], truth.height[cells.at(i, 10)], 2e-3);
}

}  // namespace
}  // namespace swath::terrain
