// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/roofs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

/// Level planes 6 m above the ground in the cells of rectangles.
struct Planes {
  StructureCells cells;
  Districts where;
  std::vector<std::uint8_t> standing, decks;

  Planes() {
    cells.lattice = {1.0, 0, 0, 60, 36};
    cells.plane.assign(cells.lattice.size(), none);
    cells.height = cells.ground = cells.low = cells.plane;
    cells.low.assign(cells.lattice.size(), 0.0f);
    cells.kind.assign(cells.lattice.size(), Planar::none);
    cells.sums.assign(cells.lattice.size(), {});
    where.lattice = {district_side, 0, 0, 5, 3};
    where.side.assign(where.lattice.size(), 0);
    standing.assign(cells.lattice.size(), 0);
    decks = standing;
  }
  void add(int i0, int j0, int nx, int ny, float z, Planar kind = Planar::wide) {
    for (int j = j0; j < j0 + ny; ++j)
      for (int i = i0; i < i0 + nx; ++i) {
        const size_t c = cells.lattice.at(i, j);
        cells.plane[c] = cells.low[c] = cells.height[c] = z;
        cells.kind[c] = kind;
        for (const int x : {0, 33, 67, 100})
          for (const int y : {0, 33, 67, 100}) {
            PlanarSums& s = cells.sums[c];
            s.n += 1, s.x += x, s.y += y, s.xx += x * x, s.xy += x * y, s.yy += y * y;
          }
        standing[c] = 1;
      }
  }
  std::vector<float> roofs(double east = 60.0) const {
    core::Block corners;
    corners.x = {0.0, east}, corners.y = {0.0, 36.0}, corners.z = {0.0, 0.0};
    return roof_cells(cells, standing, decks, where, {}, OwnBox(corners, 2, 0.0));
  }
};

TEST(Roofs, LargeAndHighPlanesAreRoofsWithTheSmallPartsBesideThem) {
  Planes p;
  p.add(2, 2, 3, 3, 6.0f);                 // just large enough
  p.add(20, 2, 2, 4, 6.0f);                // too small
  p.add(40, 2, 5, 5, 1.5f);                // too low
  p.add(2, 20, 5, 5, 6.0f);                // a roof ...
  p.add(7, 20, 1, 1, 6.2f, Planar::some);  // ... and a part of it
  const std::vector<float> roofs = p.roofs();
  const auto is = [&](int i, int j) { return !std::isnan(roofs[p.cells.lattice.at(i, j)]); };
  EXPECT_TRUE(is(3, 3) && is(2, 2) && is(4, 4));
  EXPECT_FALSE(is(20, 3));
  EXPECT_FALSE(is(42, 4));
  EXPECT_TRUE(is(4, 22) && is(7, 20));
}

TEST(Roofs, OnlyThoseThatBeginInTheBoxAreLookedFor) {
  Planes p;
  p.add(2, 2, 9, 9, 6.0f);
  p.add(40, 2, 9, 9, 6.0f);
  const std::vector<float> roofs = p.roofs(20.0);
  EXPECT_EQ(roofs[p.cells.lattice.at(5, 5)], 6.0f);
  EXPECT_TRUE(std::isnan(roofs[p.cells.lattice.at(45, 5)]));
}

TEST(Roofs, EveryCellOfARoofOfAnyFormIsOne) {
  Planes p;  // galleries around a court: none of their squares holds all
  p.add(2, 2, 30, 3, 6.0f), p.add(2, 29, 30, 3, 6.0f), p.add(2, 5, 3, 24, 6.0f), p.add(29, 5, 3, 24, 6.0f);
  p.add(40, 4, 1, 8, 6.0f), p.add(42, 4, 1, 8, 6.0f), p.add(44, 4, 1, 8, 6.0f);  // linked over gaps
  p.standing.assign(p.standing.size(), 0);                                       // nothing is filled
  const std::vector<float> roofs = p.roofs();
  for (size_t c = 0; c < roofs.size(); ++c) EXPECT_EQ(std::isnan(roofs[c]), std::isnan(p.cells.plane[c])) << c % 60 << " " << c / 60;
}

TEST(Roofs, AGapIsFilledWhereSomethingStandsInItAndADeckIsNone) {
  Planes p;
  p.add(2, 2, 9, 9, 6.0f);
  for (const int j : {5, 7}) p.cells.plane[p.cells.lattice.at(5, j)] = none, p.cells.kind[p.cells.lattice.at(5, j)] = Planar::none;
  p.standing[p.cells.lattice.at(5, 7)] = 0;
  const std::vector<float> roofs = p.roofs();
  EXPECT_EQ(roofs[p.cells.lattice.at(5, 5)], 6.0f);
  EXPECT_TRUE(std::isnan(roofs[p.cells.lattice.at(5, 7)]));
  p.decks = p.standing;
  for (const float z : p.roofs()) EXPECT_TRUE(std::isnan(z));
}

TEST(Roofs, APlaneGoesOnBelowTheLeastHeight) {
  Planes p;
  p.add(5, 5, 6, 6, 2.1f);
  p.add(11, 5, 6, 6, 1.8f);
  p.add(30, 30, 6, 6, 1.8f);  // alone
  const std::vector<float> roofs = p.roofs();
  const auto is = [&](int i, int j) { return !std::isnan(roofs[p.cells.lattice.at(i, j)]); };
  EXPECT_TRUE(is(7, 7) && is(13, 7) && is(16, 10));
  EXPECT_FALSE(is(32, 32));
}

TEST(Roofs, LongRowsOfCellsCountFromEachOfThem) {
  Planes p;
  p.add(2, 10, 56, 3, 6.0f);
  const std::vector<float> roofs = p.roofs();
  for (int i = 2; i < 58; ++i) EXPECT_EQ(roofs[p.cells.lattice.at(i, 10)], 6.0f) << i;
}

TEST(Roofs, WhatStandsAloneAndIsAsNarrowAsAVehicleIsNone) {
  Planes p;
  p.add(5, 5, 8, 2, 3.0f);    // a lorry
  p.add(25, 5, 8, 3, 3.0f);   // a row of garages
  p.add(5, 20, 8, 2, 3.0f);   // a lean-to ...
  p.add(5, 22, 8, 6, 9.0f);   // ... and its house
  p.add(30, 25, 8, 2, 3.0f);  // may be the rest of a roof ...
  for (int i = 25; i < 45; ++i)
    for (int j = 27; j < 36; ++j) p.cells.low[p.cells.lattice.at(i, j)] = none;  // ... beyond the data
  const std::vector<float> roofs = p.roofs();
  const auto is = [&](int i, int j) { return !std::isnan(roofs[p.cells.lattice.at(i, j)]); };
  for (int i = 5; i < 13; ++i) EXPECT_FALSE(is(i, 5) || is(i, 6)) << i;
  for (int i = 25; i < 33; ++i) EXPECT_TRUE(is(i, 5) && is(i, 7)) << i;
  for (int i = 5; i < 13; ++i) EXPECT_TRUE(is(i, 20) && is(i, 21) && is(i, 25)) << i;
  for (int i = 30; i < 38; ++i) EXPECT_TRUE(is(i, 25) && is(i, 26)) << i;
}

}  // namespace
}  // namespace swath::filters
