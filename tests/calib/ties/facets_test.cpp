// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/facets.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <tuple>

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using Height = std::function<double(double, double)>;

/// Looks of several lines at a surface over a square of 60 m: 4 returns/m^2 each, each line shifted in height.
PlaneCells cells_of(const Height& surface, const std::vector<double>& line_shift, double noise = 0.02) {
  PlaneCells out;
  out.side = 2.0, out.density = 4.0;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0.0, 60.0);
  std::normal_distribution<double> normal;
  std::map<std::tuple<CellIndex3, std::uint32_t>, Moments<float>> all;
  for (std::uint32_t l = 0; l < line_shift.size(); ++l) {
    out.lines.push_back({static_cast<int>(l) + 1, 100.0 * l, 100.0 * l + 10.0});
    for (int i = 0; i < 4 * 3600; ++i) {
      const double x = uniform(random), y = uniform(random), z = surface(x, y) + line_shift[l] + noise * normal(random);
      const CellIndex3 c = cell_of(x, y, z, out.side);
      const Vector3d at = Vector3d(x, y, z) - centre_of(c, out.side);
      all[{c, l}].add(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()));
    }
  }
  for (const auto& [key, m] : all)
    if (m.n >= 3) out.looks.push_back({std::get<0>(key), std::get<1>(key), 100.0 * std::get<1>(key), 100.0 * std::get<1>(key) + 1.0, m});
  return out;
}

// Gable of 24 m by 16 m, 30 deg, on level ground.
double gabled(double x, double y) {
  if (x < 18 || x > 42 || y < 22 || y > 38) return 0.0;
  return 10.0 - 0.577 * std::abs(y - 30.0);
}

TEST(Facets, RoofsAndGroundAreFoundWithTheirNormals) {
  core::Tally tally;
  const std::vector<Facet> facets = find_facets(cells_of(gabled, {0.0, 0.0, 0.0}), {}, tally);
  int roofs = 0, ground = 0;
  for (const Facet& f : facets) {
    const double x = f.centre.x(), y = f.centre.y();
    EXPECT_NEAR(f.centre.z(), gabled(x, y), 0.05);
    EXPECT_EQ(f.looks.size(), 3u);
    EXPECT_LE(f.half.maxCoeff(), 0.6 * 12.0);
    EXPECT_GE(f.half.minCoeff(), 1.5);
    if (f.kind == TieKind::roof) {
      ++roofs;
      const Vector3d truth = Vector3d(0.0, y > 30 ? 0.577 : -0.577, 1.0).normalized();
      EXPECT_LT((f.normal - truth).norm(), 0.02);
    } else {
      ++ground;
      EXPECT_EQ(f.kind, TieKind::ground);
      EXPECT_GT(f.normal.z(), 0.999);
    }
  }
  EXPECT_GE(roofs, 4);
  EXPECT_GE(ground, 12);
  EXPECT_GT(tally.of("cells"), 900u);
}

TEST(Facets, LinesThatMissOneAnotherAreStillPlaneEach) {
  core::Tally tally, shifted;
  FacetOptions o;
  const size_t without = find_facets(cells_of(gabled, {0.0, 0.0, 0.0}), o, tally).size();
  o.mismatch = 0.5;
  const size_t with = find_facets(cells_of(gabled, {0.4, -0.4, 0.1}), o, shifted).size();
  EXPECT_GT(with, without * 7 / 10);
}

TEST(Facets, WoodsHaveNone) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> crown(0.0, 14.0);
  core::Tally tally;
  EXPECT_TRUE(find_facets(cells_of([&](double, double) { return crown(random); }, {0.0, 0.0, 0.0}), {}, tally).empty());
  EXPECT_GT(tally.of("cells refused: not plane"), 0u);
}

TEST(Facets, OneLineAloneTiesNothing) {
  core::Tally tally;
  EXPECT_TRUE(find_facets(cells_of(gabled, {0.0}), {}, tally).empty());
  EXPECT_GT(tally.of("cells refused: one line"), 500u);
}

/// Looks at a wall of 14 m by 6 m that two lines see with 0.8 returns/m^2 each, over ground with 4.
PlaneCells walled() {
  PlaneCells out;
  out.side = 1.6, out.density = 4.0;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::map<std::tuple<CellIndex3, std::uint32_t>, Moments<float>> all;
  for (std::uint32_t l = 0; l < 2; ++l) {
    out.lines.push_back({static_cast<int>(l) + 1, 100.0 * l, 100.0 * l + 10.0});
    const auto add = [&](const Vector3d& p) {
      const CellIndex3 c = cell_of(p.x(), p.y(), p.z(), out.side);
      const Vector3d at = p - centre_of(c, out.side);
      all[{c, l}].add(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()));
    };
    for (int i = 0; i < 67; ++i) add({10.0 + 14.0 * uniform(random), 12.0 + 0.03 * normal(random), 6.0 * uniform(random)});
    for (int i = 0; i < 4 * 30 * 12; ++i) add({30.0 * uniform(random), 12.0 * uniform(random), 0.02 * normal(random)});
  }
  for (const auto& [key, m] : all)
    out.looks.push_back({std::get<0>(key), std::get<1>(key), 100.0 * std::get<1>(key), 100.0 * std::get<1>(key) + 1.0, m});
  return out;
}

TEST(Facets, AWallOfFewReturnsIsFoundWithItsNeighbours) {
  core::Tally tally;
  FacetOptions o;
  const auto walls = [&] {
    std::vector<Facet> out;
    for (const Facet& f : find_facets(walled(), o, tally))
      if (f.kind == TieKind::wall) out.push_back(f);
    return out;
  };
  EXPECT_TRUE(walls().empty());
  o.thin_walls = true;
  const std::vector<Facet> found = walls();
  ASSERT_FALSE(found.empty());
  for (const Facet& f : found) {
    EXPECT_GT(std::abs(f.normal.y()), 0.998);
    EXPECT_NEAR(f.centre.y(), 12.0, 0.03);
    EXPECT_EQ(f.looks.size(), 2u);
    EXPECT_GE(f.half.minCoeff(), 1.5);
  }
}

// A wood's single returns make no walls.
TEST(Facets, ThinCellsOfAWoodAreNoWalls) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> crown(0.0, 14.0);
  core::Tally tally;
  FacetOptions o;
  o.thin_walls = true;
  EXPECT_TRUE(find_facets(cells_of([&](double, double) { return crown(random); }, {0.0, 0.0, 0.0}), o, tally).empty());
}

TEST(Facets, ASlopeOfTheGroundIsNoRoof) {
  core::Tally tally;
  const auto facets = find_facets(cells_of([](double x, double y) { return 0.2 * x + 0.1 * y; }, {0.0, 0.0}), {}, tally);
  ASSERT_FALSE(facets.empty());
  for (const Facet& f : facets) EXPECT_EQ(f.kind, TieKind::ground);
}

TEST(Facets, TheSpreadTakesFromEverySquareInTurn) {
  std::vector<Facet> all;
  for (int k = 0; k < 400; ++k) {
    Facet f;
    // Nine tenths of them crowd in one square.
    f.centre = k % 10 ? Vector3d(5.0 + 0.01 * k, 5.0, 0.0) : Vector3d(100.0 * (1 + k / 10), 50.0, 0.0);
    f.half = {2.0, 2.0};
    f.looks.resize(k == 7 ? 5 : 2);
    all.push_back(f);
  }
  const auto some = spread(all, 60, 50.0);
  ASSERT_EQ(some.size(), 60u);
  int crowd = 0, best = 0;
  for (const Facet& f : some) crowd += f.centre.x() < 50.0, best += f.looks.size() == 5;
  EXPECT_EQ(crowd, 20) << "forty squares of one each, the rest from the crowd";
  EXPECT_EQ(best, 1) << "seen by most lines: first in its square";
  EXPECT_EQ(spread(all, 1000, 50.0).size(), 400u);
}

TEST(Facets, SlopesAreKeptBeforeLevelGround) {
  FacetOptions o;
  o.most = 8;
  core::Tally tally;
  const auto facets = find_facets(cells_of(gabled, {0.0, 0.0, 0.0}), o, tally);
  ASSERT_EQ(facets.size(), 8u);
  int roofs = 0;
  for (const Facet& f : facets) roofs += f.kind == TieKind::roof;
  EXPECT_GE(roofs, 4);
  EXPECT_GT(tally.of("facets beyond the most planes"), 0u);
}

}  // namespace
}  // namespace swath::calib
