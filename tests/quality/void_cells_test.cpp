// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/void_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "quality/pulse_density.h"

namespace swath::quality {
namespace {

constexpr double side = 100.0, spacing = 0.5;

/// A regular pattern of first returns, `spacing` apart, moved by a third of it at random; `is_hole`: where there is none.
template <class F>
core::Block pattern(F&& is_hole, double rotation = 0.3) {
  core::Block b;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> shift(-spacing / 6, spacing / 6);
  const int n = static_cast<int>(side / spacing);
  for (int i = -n; i < 2 * n; ++i)
    for (int j = -n; j < 2 * n; ++j) {
      const double u = spacing * (i - n / 2), v = spacing * (j - n / 2);
      const double x = 0.5 * side + u * std::cos(rotation) - v * std::sin(rotation) + shift(random),
                   y = 0.5 * side + u * std::sin(rotation) + v * std::cos(rotation) + shift(random);
      if (x < -10 || y < -10 || x > side + 10 || y > side + 10 || is_hole(x, y)) continue;
      b.x.push_back(x), b.y.push_back(y), b.z.push_back(0.0);
    }
  return b;
}

double area_of(const std::vector<VoidRun>& runs, const PulseSpacing& s) {
  double cells = 0.0;
  for (const VoidRun& r : runs) cells += r.i1 - r.i0;
  return cells * void_cell(s) * void_cell(s);
}

core::Lattice window(const PulseSpacing& s, double x0 = 0.0, double x1 = side) { return core::lattice_of(void_cell(s), x0, 0.0, x1, side); }

/// The edge of a void is known to 0.05 spacings on average: 1.5 % of the area of a square of 30 spacings of the rule, 2 % here. Of smaller
/// ones the disc leaves out a larger share of the corners.
TEST(VoidCells, AreaIsRightToTwoPercent) {
  for (const double rotation : {0.0, 0.3, 0.7})
    for (const double half : {8.0, 20.0}) {
      const core::Block b = pattern([&](double x, double y) { return std::abs(x - 47.3) < half && std::abs(y - 52.1) < half; }, rotation);
      for (const double rule : {spacing, 2.0 * spacing}) {
        if (2.0 * half < 30.0 * rule) continue;
        const PulseSpacing s{rule, spacing};
        EXPECT_NEAR(area_of(find_voids(b, window(s), s), s), 4 * half * half, 0.02 * 4 * half * half)
            << rotation << " " << half << " " << rule;
      }
    }
}

TEST(VoidCells, ARegularPatternHasNone) {
  const PulseSpacing s{spacing, spacing};
  EXPECT_TRUE(find_voids(pattern([](double, double) { return false; }), window(s), s).empty());
}

/// Returns 2 m apart by a rule of 0.35 m: void is what is farther than 0.7 m from all of them, 1 - pi 0.7^2 / 4 of the area.
TEST(VoidCells, FarTooSparsePointsLeaveTheSpaceBetweenThemVoid) {
  core::Block b;
  for (double x = 0.5; x < side; x += 2.0)
    for (double y = 0.5; y < side; y += 2.0) b.x.push_back(x), b.y.push_back(y), b.z.push_back(0.0);
  const PulseSpacing s{0.35, 2.0};
  const core::Lattice inner = core::lattice_of(void_cell(s), 10.0, 10.0, 90.0, 90.0);
  const double area = inner.nx * inner.ny * void_cell(s) * void_cell(s);
  EXPECT_NEAR(area_of(find_voids(b, inner, s), s) / area, 1.0 - 3.14159 * 0.49 / 4.0, 0.03);  // cells of 0.09 m
}

/// A gap narrower than 4 ANPS holds no disc of radius 2 ANPS.
TEST(VoidCells, NarrowGapsAreNone) {
  const PulseSpacing s{spacing, spacing};
  const auto gap = [](double width) { return [width](double x, double) { return std::abs(x - 50.0) < 0.5 * width; }; };
  EXPECT_TRUE(find_voids(pattern(gap(2.0 * spacing)), window(s), s).empty());
  EXPECT_GT(area_of(find_voids(pattern(gap(6.0 * spacing)), window(s), s), s), 0.8 * 6.0 * spacing * side);
}

TEST(VoidCells, TilesMakeTheWhole) {
  const PulseSpacing s{spacing, spacing};
  const core::Block b = pattern([](double x, double y) { return std::hypot(x - 50.0, y - 50.0) < 20.0; });
  const double whole = area_of(find_voids(b, window(s), s), s);
  EXPECT_NEAR(area_of(find_voids(b, window(s, 0.0, 50.0), s), s) + area_of(find_voids(b, window(s, 50.0, side), s), s), whole, 1e-9);
}

/// Distances are taken in squares of 1024 cells, here 64 m: voids that cross their borders are those of windows that lie in one of them.
TEST(VoidCells, SquaresOfTheSearchMakeTheWhole) {
  const PulseSpacing s{0.5 * spacing, spacing};
  const core::Block b = pattern([](double x, double y) { return std::hypot(x - 64.0, y - 63.0) < 9.0 || std::abs(x - y) < 1.0; });
  const auto cells_and_rim = [&](const core::Lattice& w, std::set<std::pair<int, int>>& cells) {
    std::uint64_t rim = 0;
    for (const VoidRun& r : find_voids(b, w, s)) {
      rim += r.rim;
      for (std::int32_t i = r.i0; i < r.i1; ++i) EXPECT_TRUE(cells.insert({r.j, i}).second);
    }
    return rim;
  };
  std::set<std::pair<int, int>> whole, parts;
  const std::uint64_t rim = cells_and_rim(window(s), whole);
  std::uint64_t rim_of_parts = 0;
  for (const double x : {0.0, 50.0})
    for (const double y : {0.0, 50.0}) rim_of_parts += cells_and_rim(core::lattice_of(void_cell(s), x, y, x + 50.0, y + 50.0), parts);
  ASSERT_GT(window(s).nx, 1024);
  EXPECT_GT(whole.size(), 60000u);
  EXPECT_EQ(whole, parts);
  EXPECT_EQ(rim, rim_of_parts);
}

/// A window of 5 x 5 squares of cells with returns in the middle: those that no return comes near are void as a whole.
TEST(VoidCells, WhereThereAreNoReturnsAllIsVoid) {
  const PulseSpacing s{spacing, spacing};
  const core::Block b = pattern([](double x, double y) { return std::abs(x - 50.0) > 20.0 || std::abs(y - 50.0) > 20.0; });
  const core::Lattice wide = core::lattice_of(void_cell(s), -270.0, -270.0, 370.0, 370.0);
  const std::vector<VoidRun> runs = find_voids(b, wide, s);
  EXPECT_NEAR(area_of(runs, s), 640.0 * 640.0 - 40.0 * 40.0, 0.06 * 40.0 * 40.0);
  for (const VoidRun& r : runs) EXPECT_TRUE(r.i0 >= wide.i0 && r.i1 <= wide.i0 + wide.nx && r.j >= wide.j0 && r.j < wide.j0 + wide.ny);
}

TEST(VoidCells, TheRimSaysWhetherItIsWater) {
  const PulseSpacing s{spacing, spacing};
  core::Block b = pattern([](double x, double y) { return std::hypot(x - 50.0, y - 50.0) < 20.0; });
  b.classification.assign(b.size(), core::point_class::ground);
  for (size_t p = 0; p < b.size(); ++p)
    if (std::hypot(b.x[p] - 50.0, b.y[p] - 50.0) < 25.0 && b.x[p] > 50.0) b.classification[p] = core::point_class::water;
  double rim = 0.0, water = 0.0;
  for (const VoidRun& r : find_voids(b, window(s), s)) rim += r.rim, water += r.rim_water;
  EXPECT_GT(rim, 2 * 3.14 * 20.0 / spacing);
  EXPECT_NEAR(water / rim, 0.5, 0.05);
}

TEST(VoidCells, ShareOfCellsWithAReturn) {
  // Every second row of the pattern twice: cells of 2 spacings are all hit; of random returns exp(-4) of them are not.
  const core::Lattice cells = core::lattice_of(2.0 * spacing, 5.0, 5.0, 95.0, 95.0);
  const EvenSwath regular = even_cells(pattern([](double, double) { return false; }), cells);
  ASSERT_EQ(regular.lines.size(), 2u);
  EXPECT_EQ(regular.lines[0].line, all_lines);
  EXPECT_EQ(regular.lines[0].cells, cells.size());
  EXPECT_EQ(regular.lines[0].hit, cells.size());
  core::Block random;
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> place(0.0, side);
  for (int k = 0; k < static_cast<int>(side * side / spacing / spacing); ++k)
    random.x.push_back(place(generator)), random.y.push_back(place(generator)), random.z.push_back(0.0);
  const EvenSwath even = even_cells(random, cells);
  // 8100 cells: 0.15 % about exp(-4) = 1.8 %.
  EXPECT_NEAR(static_cast<double>(even.lines[0].hit) / static_cast<double>(even.lines[0].cells), 1.0 - std::exp(-4.0), 0.006);
}

TEST(VoidCells, RimAndHolesAreNotInTheShare) {
  const core::Lattice cells = core::lattice_of(2.0 * spacing, 0.0, 0.0, side, side);
  const EvenSwath e = even_cells(pattern([](double x, double y) { return x > 60.0 || std::hypot(x - 30.0, y - 50.0) < 10.0; }), cells);
  EXPECT_EQ(e.lines[0].hit, e.lines[0].cells);
  EXPECT_LT(e.lines[0].cells, 6000u - 314u);
  EXPECT_GT(e.lines[0].cells, 4800u);
}

}  // namespace
}  // namespace swath::quality
