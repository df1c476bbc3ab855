// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/return_grids.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

const core::Lattice window{2.0, 250000, 2300000, 2, 1};  // from (0, 0) of the Block

TEST(ReturnGrids, DensityOfPulsesAndReturns) {
  test::Made m;
  for (int k = 0; k < 6; ++k) m.add(0.1 + 0.3 * k, 1.0, 0.0);
  m.block.return_number[1] = 2, m.block.return_number[2] = 3;
  m.add(1.0, 1.0, 0.0, 0.03f, core::point_class::low_noise);
  EXPECT_EQ(density(m.block, window, false).height[0], 1.5f);
  EXPECT_EQ(density(m.block, window, true).height[0], 1.0f);
  EXPECT_EQ(density(m.block, window, true).height[1], 0.0f);
  EXPECT_EQ(density(m.block, window, true).reason[1], core::Void::none);
}

TEST(ReturnGrids, IntensityIsThatAtTheReferenceRange) {
  // One surface seen from two heights and under two angles: the same brightness.
  test::Made m;
  const auto see = [&](double range, double angle, int count) {
    m.add(0.5, 0.5, 0.0);
    core::add_columns(m.block, {core::Column::intensity, core::Column::range, core::Column::incidence, core::Column::return_count});
    m.block.range.back() = static_cast<float>(range);
    m.block.incidence.back() = static_cast<float>(angle);
    m.block.intensity.back() = static_cast<std::uint16_t>(std::lround(2000.0 * std::cos(angle) * std::pow(1000.0 / range, 2)));
    m.block.return_count.back() = static_cast<std::uint8_t>(count);
  };
  see(500.0, 0.0, 1);
  see(1500.0, 0.0, 1);
  see(800.0, 0.6, 1);
  see(800.0, 0.0, 3);  // a part of a pulse
  m.block.intensity.back() = 9;
  const core::Grid g = intensity(m.block, {1.0, 500000, 4600000, 2, 1}, {});
  EXPECT_NEAR(static_cast<double>(g.height[0]), 2000.0, 2.0);  // intensities are whole numbers
  EXPECT_EQ(g.count[0], 3u);
  EXPECT_EQ(g.reason[1], core::Void::no_data);
}

TEST(ReturnGrids, CanopyIsSurfaceLessTerrain) {
  const core::Lattice l{1.0, 0, 0, 3, 1};
  core::Grid surface = test::sampled(l, [](double x, double) { return 10.0 * x; }),
             terrain = test::sampled(l, [](double, double) { return 6.0; });
  terrain.height[2] = std::nanf("");
  terrain.reason[2] = core::Void::water;
  const core::Grid g = canopy(surface, terrain);
  EXPECT_EQ(g.height[0], 0.0f);
  EXPECT_EQ(g.height[1], 9.0f);
  EXPECT_EQ(g.reason[2], core::Void::water);
  EXPECT_THROW(canopy(core::Grid(core::Lattice{2.0, 0, 0, 3, 1}), terrain), core::Error);
}

}  // namespace
}  // namespace swath::terrain
