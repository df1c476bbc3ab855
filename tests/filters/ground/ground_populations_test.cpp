// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_populations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::filters {
namespace {

constexpr double noise = 0.03, crop = 0.12, lifted = 0.07;  // m

struct Field {
  core::Block block;
  std::vector<ReturnOverGround> returns;
};

/// 60 m x 60 m, 5 returns per m2 about a surface; where x > 30 m it lies `lifted` over the soil and 70 % of the returns are a crop's. The
/// returns of every second strip are `misfit` m higher.
Field field(double crop_height, double surface, double misfit) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> soil(0.0, 0.018);
  Field f;
  f.block.origin = {512000.0, 5402000.0, 0.0};
  core::resize(f.block, 18000);
  core::add_columns(f.block, {core::Column::strip});
  for (size_t p = 0; p < f.block.size(); ++p) {
    f.block.x[p] = 60.0 * part(random);
    f.block.y[p] = 60.0 * part(random);
    f.block.strip[p] = static_cast<std::uint16_t>(1 + p % 2);
    const bool in_field = f.block.x[p] > 30.0, plant = in_field && part(random) < 0.7;
    const double z = soil(random) + (plant ? crop_height : 0.0) - (in_field ? surface : 0.0) + (p % 2 ? 0.5 : -0.5) * misfit;
    f.returns.push_back({static_cast<float>(z), 0.05F, 0.1F, false});
  }
  return f;
}

float middle_at(const LowerPopulations& l, const core::Block& b, double x, double y) {
  return l.middle.value[l.lattice.at(static_cast<int>(core::cell_index(b.origin.x() + x, l.lattice.cell) - l.lattice.i0),
                                     static_cast<int>(core::cell_index(b.origin.y() + y, l.lattice.cell) - l.lattice.j0))];
}

TEST(GroundPopulations, SoilIsFoundUnderACropThatLiftedTheSurface) {
  const Field f = field(crop, lifted, 0.0);
  const LowerPopulations l = lower_populations(f.block, f.block.size(), 0.0, f.returns, noise);
  constexpr double bearable = 0.01;  // m
  EXPECT_NEAR(middle_at(l, f.block, 45.0, 30.0), -lifted, bearable);
  EXPECT_TRUE(std::isnan(middle_at(l, f.block, 15.0, 30.0)));
}

TEST(GroundPopulations, StripsThatDoNotFitAreOneGround) {
  const Field f = field(0.0, 0.0, 0.1);
  const LowerPopulations l = lower_populations(f.block, f.block.size(), 0.0, f.returns, noise);
  EXPECT_TRUE(std::isnan(middle_at(l, f.block, 15.0, 30.0)));
  Field unnamed = f;
  unnamed.block.strip.clear();
  const LowerPopulations without = lower_populations(unnamed.block, f.block.size(), 0.0, f.returns, noise);
  EXPECT_FALSE(std::isnan(middle_at(without, f.block, 15.0, 30.0)));
}

TEST(GroundPopulations, NeitherOrderNorWhatLiesFarAwayMatters) {
  const Field f = field(crop, lifted, 0.03);
  const LowerPopulations whole = lower_populations(f.block, f.block.size(), 0.0, f.returns, noise);
  // Own points from x = 28 m to 40 m first, then those within reach, all backwards.
  std::vector<std::uint32_t> rows, around;
  for (auto p = static_cast<std::uint32_t>(f.block.size()); p-- > 0;) {
    const double x = f.block.x[p];
    if (x > 28.0 && x < 40.0)
      rows.push_back(p);
    else if (x > 28.0 - ground_populations_reach && x < 40.0 + ground_populations_reach)
      around.push_back(p);
  }
  const size_t own = rows.size();
  rows.insert(rows.end(), around.begin(), around.end());
  ASSERT_LT(rows.size(), f.block.size());
  std::vector<ReturnOverGround> returns;
  for (const std::uint32_t p : rows) returns.push_back(f.returns[p]);
  const core::Block part_block = core::select(f.block, rows);
  const LowerPopulations part = lower_populations(part_block, own, 0.0, returns, noise);
  size_t found = 0;
  for (double x = 28.5; x < 40.0; x += 1.0)
    for (double y = 4.5; y < 56.0; y += 1.0) {
      const float a = middle_at(whole, f.block, x, y), b = middle_at(part, f.block, x, y);
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << x << " " << y;
      found += !std::isnan(a);
    }
  EXPECT_GT(found, 100u);
}

}  // namespace
}  // namespace swath::filters
