// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/return_grids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
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
  const DensityOptions o{core::Metres(2.0), core::Metres(10.0)};
  EXPECT_EQ(density(m.block, window, o, false).height[0], 1.5f);
  EXPECT_EQ(density(m.block, window, o, true).height[0], 1.0f);
  EXPECT_THROW(density(m.block, window, {}, true), core::Error);
}

TEST(ReturnGrids, NoReturnIsZeroWithinTheSurveyAndVoidBeyondItsEdge) {
  test::Made m;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i)
      if (i < 12 || i >= 18 || j < 12 || j >= 18) m.add(i + 0.5, j + 0.5, 0.0);
  m.block.return_number.assign(m.block.size(), 1);
  m.block.return_number[31] = 2;  // a cell with a return and without a pulse
  const core::Lattice wide{1.0, 499990, 4599990, 60, 50};
  const DensityOptions o{core::Metres(1.0), core::Metres(8.0)};
  for (const bool pulses : {false, true}) {
    const core::Grid g = density(m.block, wide, o, pulses);
    EXPECT_EQ(g.height[wide.at(10 + 15, 10 + 15)], 0.0f);  // the gap's middle
    EXPECT_EQ(g.height[wide.at(10 + 3, 10 + 3)], 1.0f);
    EXPECT_EQ(g.height[wide.at(10 + 1, 10 + 1)], pulses ? 0.0f : 1.0f);
    for (const auto& [i, j] : {std::pair{5, 20}, {45, 20}, {20, 45}, {0, 0}}) {
      EXPECT_EQ(g.reason[wide.at(i, j)], core::Void::no_data) << i << " " << j;
      EXPECT_TRUE(std::isnan(g.height[wide.at(i, j)]));
    }
    // A part of the window with no more than the halo's points says the same.
    const core::Lattice part{1.0, 499990 + 20, 4599990 + 20, 40, 12};
    core::Block near;
    near.origin = m.block.origin;
    std::vector<std::uint32_t> rows;
    for (std::uint32_t r = 0; r < m.block.size(); ++r) {
      const double x = m.block.x[r] + m.block.origin.x(), y = m.block.y[r] + m.block.origin.y(), h = halo(o);
      if (x >= part.west() - h && x < part.east() + h && y >= part.south() - h && y < part.north() + h) rows.push_back(r);
    }
    const core::Grid own = density(core::select(m.block, rows), part, o, pulses);
    for (int j = 0; j < part.ny; ++j)
      for (int i = 0; i < part.nx; ++i) EXPECT_EQ(own.reason[part.at(i, j)], g.reason[wide.at(i + 20, j + 20)]) << i << " " << j;
  }
}

TEST(ReturnGrids, ASlopeIsAsBrightAsTheFlat) {
  // A plane that rises by 30 degrees to the east, seen from straight above: its returns are weaker by the cosine.
  const double rise = std::tan(core::pi / 6.0);
  test::Made m;
  std::vector<Eigen::Vector3d> scanner;
  core::add_columns(m.block, {core::Column::intensity, core::Column::range, core::Column::incidence});
  for (int k = 0; k < 40; ++k) {
    const double x = 0.25 * k;
    m.add(x, 4.5, rise * x);
    scanner.emplace_back(x, 4.5, 1000.0 + rise * x);
  }
  core::add_columns(m.block, {core::Column::intensity, core::Column::range, core::Column::incidence, core::Column::return_count});
  m.block.range.assign(40, 1000.0f);
  m.block.intensity.assign(40, static_cast<std::uint16_t>(std::lround(20000.0 * std::cos(core::pi / 6.0))));
  m.block.return_count.assign(40, 1);
  core::Grid terrain = test::sampled({1.0, 499997, 4599997, 16, 16}, [&](double x, double) { return rise * (x - 500000.0); });
  const core::Lattice l{1.0, 500000, 4600000, 10, 10};
  set_incidence(m.block, terrain, scanner);
  EXPECT_NEAR(static_cast<double>(intensity(m.block, l, {}).height[l.at(5, 4)]), 20000.0, 2.0);
  // Where the terrain is not known the beam's angle to the vertical stays.
  std::fill(terrain.height.begin(), terrain.height.end(), std::nanf(""));
  m.block.incidence.assign(40, 0.0f);
  set_incidence(m.block, terrain, scanner);
  EXPECT_NEAR(static_cast<double>(intensity(m.block, l, {}).height[l.at(5, 4)]), 20000.0 * std::cos(core::pi / 6.0), 2.0);
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
