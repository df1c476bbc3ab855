// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground_populations.h"

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

}  // namespace
}  // namespace swath::filters
