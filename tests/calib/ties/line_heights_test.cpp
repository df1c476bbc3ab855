// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/line_heights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::calib {
namespace {

/// Returns on a lattice of 0.5 m over 40 x 40 m about (500 000, 5 300 000), by a surface.
template <class F>
core::Block returns_on(F&& height) {
  core::Block b;
  b.origin = {500000, 5300000, 600};
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) {
      b.x.push_back(0.25 + 0.5 * i);
      b.y.push_back(0.25 + 0.5 * j);
      b.z.push_back(height(b.x.back(), b.y.back()));
    }
  return b;
}

TEST(LineHeights, PlanesThatDifferByAConstantAlongTheirNormal) {
  const double slope = 0.75;  // cos = 0.8
  LineHeights heights({}, 2.0);
  heights.add(4, returns_on([&](double x, double) { return slope * x; }));
  heights.add(2, returns_on([&](double x, double) { return slope * x + 0.10; }));
  const auto maps = line_differences(heights);
  ASSERT_EQ(maps.size(), 1u);
  const LineDifferenceStatistics& s = maps[0].statistics;
  EXPECT_EQ(s.line_a, 2);
  EXPECT_EQ(s.line_b, 4);
  EXPECT_EQ(s.cells, 400u);
  constexpr double exact = 1e-9;  // the arithmetic alone
  EXPECT_NEAR(s.mean, 0.08, exact);
  EXPECT_NEAR(s.rms, 0.08, exact);
  EXPECT_NEAR(s.median_abs, 0.08, exact);
  EXPECT_NEAR(overall_rms(maps), 0.08, exact);
  EXPECT_EQ(maps[0].grid.lattice.nx, 20);
  for (const float d : maps[0].grid.height) EXPECT_NEAR(d, 0.10, 1e-6);
}

TEST(LineHeights, RoughCellsAndLaterReturnsTakeNoPart) {
  LineHeights heights({}, 2.0);
  heights.add(1, returns_on([](double, double) { return 0.0; }));
  core::Block rough = returns_on([](double x, double y) { return x < 20 ? 0.05 : 3.0 * std::sin(17 * x) * std::cos(13 * y); });
  // A second return below each pulse, which a mean would notice.
  rough.return_number.assign(rough.size(), 1);
  rough.return_count.assign(rough.size(), 1);
  core::Block deep = rough;
  for (double& z : deep.z) z -= 5;
  deep.return_number.assign(deep.size(), 2);
  deep.return_count.assign(deep.size(), 2);
  core::append(rough, deep);
  heights.add(2, rough);
  const auto maps = line_differences(heights);
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].statistics.cells, 200u) << "the smooth half";
  EXPECT_NEAR(maps[0].statistics.mean, -0.05, 1e-9);
}

TEST(LineHeights, ALineInTwoPiecesIsOneLine) {
  const auto flat = [](double level) { return [level](double, double) { return level; }; };
  LineHeights heights({}, 2.0);
  core::Block few = returns_on(flat(0.0));
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < few.size(); ++i)
    if (few.y[i] < 20) rows.push_back(i);
  heights.add(1, core::select(few, rows));
  heights.add(2, returns_on(flat(1.0)));
  heights.add(1, returns_on(flat(0.2)));
  const auto maps = line_differences(heights);
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].statistics.cells, 400u);
  EXPECT_NEAR(maps[0].grid.height.front(), -1.0, 1e-6) << "cells of equally many returns keep the first piece";
  EXPECT_NEAR(maps[0].grid.height.back(), -0.8, 1e-6);
}

TEST(LineHeights, WithoutOverlapThereIsNoPair) {
  LineHeights heights({}, 2.0);
  heights.add(1, returns_on([](double, double) { return 0.0; }));
  core::Block away = returns_on([](double, double) { return 0.0; });
  away.origin.x() += 1000;
  heights.add(2, away);
  EXPECT_TRUE(line_differences(heights).empty());
  EXPECT_EQ(overall_rms({}), 0.0);
}

}  // namespace
}  // namespace swath::calib
