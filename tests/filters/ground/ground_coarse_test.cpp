// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_coarse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace swath::filters {
namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

GroundSurfaceOptions small() { return {.widest = 12.0, .longest = 20.0}; }

/// Hills with buildings, bushes, low points and holes.
Raster country(int nx, int ny) {
  Raster r(nx, ny, 0.0F);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      double z = 8.0 * std::sin(i / 25.0) * std::cos(j / 31.0) + 0.05 * part(random);
      if (i % 40 < 10 && j % 33 < 9) z += 6.0;
      if (part(random) < 0.1) z += 3.0 * part(random);
      if (part(random) < 0.002) z -= 4.0;
      r.value[r.at(i, j)] = part(random) < 0.15 ? nothing : static_cast<float>(z);
    }
  return r;
}

/// The same with level land at the western rim, houses on it, and before each a roof that the rim cuts.
Raster country_with_annexes(int nx, int ny) {
  Raster r = country(nx, ny);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < 90; ++i) {
      const bool house = i < 16 && j % 50 >= 10 && j % 50 < 28;
      r.value[r.at(i, j)] = 0.03F * static_cast<float>((7 * i + 3 * j) % 5) + (!house ? 0.0F : i < 3 ? 3.0F : 11.0F);
    }
  return r;
}

/// Of the country, within a rim without returns.
Raster with_rim(const Raster& inner, int rim) {
  Raster r(inner.nx + 2 * rim, inner.ny + 2 * rim, nothing);
  for (int j = 0; j < inner.ny; ++j)
    for (int i = 0; i < inner.nx; ++i) r.value[r.at(i + rim, j + rim)] = inner.value[inner.at(i, j)];
  return r;
}

TEST(CoarseGround, BuildingsAndLowPointsAreOff) {
  const GroundSurfaceOptions o = small();
  const int rim = coarse_ground_rim(o), side = 160;
  const Raster all = with_rim(country(side, side), rim);
  const core::Lattice l{1.0, 0, 0, all.nx, all.ny};
  const Raster ground = coarse_ground(all, l, l, o);
  constexpr double tolerance = 1.5;  // m: half of a building's height and more than a bush between gaps
  int off = 0;
  for (int j = 5; j < side - 5; ++j)
    for (int i = 5; i < side - 5; ++i)
      off += !(std::abs(ground.value[ground.at(i + rim, j + rim)] - 8.0 * std::sin(i / 25.0) * std::cos(j / 31.0)) < tolerance);
  EXPECT_LT(off, 0.01 * side * side);
}

TEST(CoarseGround, ARaggedRoofAtTheRimIsOffInWiderCells) {
  // Returns on the roof alternate with those on dormers and in light wells, so that no cell of 1 m goes on to the next.
  const GroundSurfaceOptions o{};
  const int rim = coarse_ground_rim(o), side = 140;
  Raster inner(side, side, 0.0F);
  for (int j = 0; j < 14; ++j)
    for (int i = 50; i < 80; ++i) inner.value[inner.at(i, j)] = (i + j) % 2 == 0 ? 6.0F : 8.5F;
  const Raster all = with_rim(inner, rim);
  const core::Lattice l{1.0, 0, 0, all.nx, all.ny};
  const Raster ground = coarse_ground(all, l, l, o);
  for (int j = 0; j < 12; ++j)
    for (int i = 52; i < 78; ++i) EXPECT_LT(ground.value[ground.at(i + rim, j + rim)], 0.5F) << i << " " << j;
}

/// `i0`, `j0`: of the whole raster in the survey's lattice. `east`: of the part, in cells from the rim.
void expect_part_of_whole(const GroundSurfaceOptions& o, int i0, int j0, int east) {
  const int rim = coarse_ground_rim(o), reach = coarse_ground_reach(o), side = 2 * reach + 60;
  const Raster all = with_rim(country_with_annexes(side, side), rim);
  const core::Lattice l{1.0, i0, j0, all.nx, all.ny};
  const Raster whole = coarse_ground(all, l, l, o);
  const core::Lattice part{1.0, i0 + rim + east, j0 + rim + reach + 3, 40, 45};
  const Raster cut = coarse_ground(all, l, part, o);
  // A raster of its own without what lies beyond the reach.
  const core::Lattice own = grown(part, reach, l);
  Raster near(own.nx, own.ny, nothing);
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i)
      near.value[near.at(i, j)] = all.value[all.at(static_cast<int>(own.i0) - i0 + i, static_cast<int>(own.j0) - j0 + j)];
  const Raster alone = coarse_ground(near, own, part, o);
  for (int j = 0; j < part.ny; ++j)
    for (int i = 0; i < part.nx; ++i) {
      const float expected = whole.value[whole.at(static_cast<int>(part.i0) - i0 + i, static_cast<int>(part.j0) - j0 + j)];
      ASSERT_EQ(cut.value[cut.at(i, j)], expected) << i << " " << j;
      ASSERT_EQ(alone.value[alone.at(i, j)], expected) << i << " " << j;
    }
}

TEST(CoarseGround, APartIsWhatItIsInTheWhole) {
  const int inside = coarse_ground_reach(small()) + 7;
  expect_part_of_whole(small(), 0, 0, inside);
  expect_part_of_whole(small(), -7, 13, inside);
  const GroundSurfaceOptions wide{.widest = 120.0, .longest = 20.0};
  expect_part_of_whole(wide, 5, -8, coarse_ground_reach(wide) + 7);
  for (const int east : {-3, 20, 60, 110, 180}) expect_part_of_whole(small(), 3, 4, east);
}

TEST(CoarseGround, ARoofThatTheRimCutsIsOffThoughAHouseHidesItsWalls) {
  const GroundSurfaceOptions o{};
  const int rim = coarse_ground_rim(o), side = 140;
  Raster inner(side, side, 0.0F);
  for (int j = 50; j < 74; ++j)
    for (int i = 0; i < 20; ++i) inner.value[inner.at(i, j)] = i < 3 ? 3.0F : 9.0F;
  const Raster all = with_rim(inner, rim);
  const core::Lattice l{1.0, 0, 0, all.nx, all.ny};
  const Raster ground = coarse_ground(all, l, l, o);
  for (int j = 50; j < 74; ++j)
    for (int i = 0; i < 20; ++i) EXPECT_LT(ground.value[ground.at(i + rim, j + rim)], 0.5F) << i << " " << j;
}

TEST(CoarseGround, AGrownLatticeEndsWhereTheWholeDoes) {
  const core::Lattice whole{1.0, -10, 20, 50, 40}, part{1.0, -5, 30, 10, 10};
  EXPECT_EQ(grown(part, 3, whole), (core::Lattice{1.0, -8, 27, 16, 16}));
  EXPECT_EQ(grown(part, 100, whole), whole);
}

}  // namespace
}  // namespace swath::filters
