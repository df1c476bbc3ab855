// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/void_rims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <tuple>

#include "core/statistics.h"
#include "quality/void_areas.h"

namespace swath::quality {
namespace {

constexpr double spacing = 0.5, length = 240.0, width = 160.0;

struct Place {
  double z = 0.0;
  bool returns = true;
};
using Scene = std::function<Place(double x, double y)>;

core::Block cloud(const Scene& scene, unsigned seed = 3) {
  core::Block b;
  b.origin = {1000.0, 2000.0, 50.0};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.3 * spacing, 0.3 * spacing);
  std::normal_distribution<double> error(0.0, 0.02);
  for (double y = 0.25; y < width; y += spacing)
    for (double x = 0.25; x < length; x += spacing) {
      const double u = x + shift(random), v = y + shift(random);
      const Place p = scene(u, v);
      if (!p.returns) continue;
      b.x.push_back(u), b.y.push_back(v), b.z.push_back(p.z + error(random));
      b.return_number.push_back(1), b.return_count.push_back(1), b.flags.push_back(0), b.strip.push_back(1);
      b.classification.push_back(p.z > 2.5 ? core::point_class::building : core::point_class::ground);
    }
  return b;
}

/// Voids of the cloud, its tiles 80 m wide where `tiled`.
SwathVoids voids_of(const core::Block& b, bool tiled = false) {
  const PulseSpacing s{spacing, spacing};
  std::vector<VoidRun> runs;
  std::vector<RimPiece> rims;
  for (double x = 0.0; x < length; x += tiled ? 80.0 : length) {
    const core::Lattice w = core::lattice_of(void_cell(s), 1000.0 + x, 2000.0, 1000.0 + x + (tiled ? 80.0 : length), 2000.0 + width);
    const double halo = std::max(void_halo(spacing), rim_halo(spacing));
    std::vector<std::uint32_t> rows;
    for (std::uint32_t p = 0; p < b.size(); ++p)
      if (b.x[p] > x - halo && b.x[p] < x + (tiled ? 80.0 : length) + halo) rows.push_back(p);
    const core::Block tile = core::select(b, rows);
    const std::vector<VoidRun> mine = find_voids(tile, w, s);
    const std::vector<RimPiece> pieces = rims_of(tile, mine, s);
    runs.insert(runs.end(), mine.begin(), mine.end());
    rims.insert(rims.end(), pieces.begin(), pieces.end());
  }
  return judge_voids(runs, footprint_of(b, b.size(), s), {}, s, 0.0, rims);
}

/// A canal of 10 m width and 80 m length from the middle, banks rising by 1 : 2 to 0.6 m; falling along it by `fall`.
Place canal(double x, double y, double fall = 0.0) {
  const double out = std::max(std::abs(y - 80.0) - 5.0, std::abs(x - 120.0) - 40.0);
  return {std::min(0.6, 0.5 * std::max(0.0, out)) - fall * x, out > 0.0};
}
constexpr double canal_area = 10.0 * 80.0;

TEST(VoidRims, ReturnsOnTheBlocksOriginAreTheFarthest) {
  const PulseSpacing s{spacing, spacing};
  const core::Lattice w = core::lattice_of(void_cell(s), 1000.0, 2000.0, 1000.0 + length, 2000.0 + width);
  core::Block b = cloud([](double x, double y) { return canal(x, y); }), moved = b;
  moved.origin += Eigen::Vector3d(length, width, 0.0);
  for (double& x : moved.x) x -= length;
  for (double& y : moved.y) y -= width;
  *std::max_element(moved.x.begin(), moved.x.end()) = 0.0;
  *std::max_element(moved.y.begin(), moved.y.end()) = 0.0;
  const std::vector<RimPiece> expected = rims_of(b, find_voids(b, w, s), s), found = rims_of(moved, find_voids(moved, w, s), s);
  EXPECT_GT(found.size(), 20U);
  EXPECT_EQ(found.size(), expected.size());
}

TEST(VoidRims, ACanalWithoutWaterPointsIsWaterAndItsAreaIsRight) {
  for (const double fall : {0.0, 0.002}) {
    const SwathVoids v = voids_of(cloud([&](double x, double y) { return canal(x, y, fall); }));
    ASSERT_EQ(v.voids.size(), 1u);
    EXPECT_EQ(v.voids[0].evidence(), "shore");
    EXPECT_NEAR(v.water_area, canal_area, 0.02 * canal_area) << fall;
    EXPECT_EQ(v.area, 0.0);
  }
}

TEST(VoidRims, BridgesAndTreesOverAPartOfTheRimChangeNothing) {
  const SwathVoids v = voids_of(cloud([&](double x, double y) {
    Place p = canal(x, y);
    if (p.returns && std::fmod(x, 20.0) < 8.0 && y > 80.0 && y < 95.0) p.z += 5.0;
    return p;
  }));
  ASSERT_EQ(v.voids.size(), 1u);
  EXPECT_EQ(v.voids[0].evidence(), "shore");
}

TEST(VoidRims, TilesChangeNothing) {
  const core::Block b = cloud([](double x, double y) { return canal(x, y); });
  const SwathVoids whole = voids_of(b), tiled = voids_of(b, true);
  ASSERT_EQ(tiled.voids.size(), 1u);
  EXPECT_EQ(tiled.water_area, whole.water_area);
}

/// None of these is water.
void expect_void(const char* what, const Scene& scene) {
  const SwathVoids v = voids_of(cloud(scene));
  ASSERT_GE(v.voids.size(), 1u) << what;
  EXPECT_EQ(v.water_area, 0.0) << what;
}

TEST(VoidRims, WhatIsNoWaterStaysAVoid) {
  const auto in = [](double x, double y, double half) { return std::max(std::abs(x - 120.0), std::abs(y - 80.0)) < half; };
  expect_void("dark car park on level ground", [&](double x, double y) { return Place{0.02 * std::sin(x), !in(x, y, 12.0)}; });
  expect_void("car park with kerbs of 15 cm", [&](double x, double y) { return Place{in(x, y, 14.0) ? 0.0 : 0.15, !in(x, y, 12.0)}; });
  expect_void("gap on a slope of 5 %", [&](double x, double y) { return Place{0.05 * x, !in(x, y, 12.0)}; });
  expect_void("gap on a steep slope", [&](double x, double y) { return Place{0.4 * y, !in(x, y, 12.0)}; });
  expect_void("dark flat roof", [&](double x, double y) { return Place{in(x, y, 16.0) ? 8.0 : 0.0, !in(x, y, 13.0)}; });
  expect_void("shadow of a hall", [&](double x, double y) {
    const bool hall = std::abs(x - 110.0) < 10.0 && std::abs(y - 80.0) < 20.0;
    return Place{hall ? 15.0 : 0.0, hall || !(x > 120.0 && x < 126.0 && std::abs(y - 80.0) < 20.0)};
  });
  expect_void("gap over a hill", [&](double x, double y) { return Place{3.0 * std::cos(0.05 * (x - 120.0)), !in(x, y, 12.0)}; });
}

TEST(VoidRims, SeveralVoidsAreJudgedEachByItsOwnRim) {
  const SwathVoids v = voids_of(cloud([](double x, double y) {
    const bool gap = std::abs(x - 120.0) < 10.0 && std::abs(y - 30.0) < 10.0;
    Place p = canal(x, y);
    return Place{p.z, p.returns && !gap};
  }));
  ASSERT_EQ(v.voids.size(), 2u);
  EXPECT_NEAR(v.water_area, canal_area, 0.02 * canal_area);
  EXPECT_NEAR(v.area, 400.0, 0.02 * 400.0);
}

/// The definition: all returns, all cells.
std::vector<RimPiece> pieces_by_definition(const core::Block& b, const std::vector<VoidRun>& runs, const PulseSpacing& s) {
  constexpr int beside = 6;  // cells
  const double side = rim_side(s.rule);
  const auto index = [](double v, double of) { return static_cast<std::int32_t>(core::cell_index(v, of)); };
  std::map<std::array<std::int32_t, 4>, RimPiece> pieces;
  for (size_t p = 0; p < b.size(); ++p) {
    const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
    const std::int32_t i = index(x, void_cell(s)), j = index(y, void_cell(s)), u = index(x, side), v = index(y, side);
    std::int32_t best = beside * beside + 1, vi = 0, vj = 0;
    for (const VoidRun& r : runs) {
      if (std::abs(r.j - j) > beside) continue;
      const std::int32_t c = std::clamp(i, r.i0, r.i1 - 1);
      if (std::abs(c - i) > beside) continue;
      if (const std::int32_t d = (c - i) * (c - i) + (r.j - j) * (r.j - j); d < best) best = d, vi = c, vj = r.j;
    }
    if (best > beside * beside) continue;
    const auto z = static_cast<float>(b.origin.z() + b.z[p]);
    const auto [at, fresh] = pieces.try_emplace({u, v, vi >> 4, vj >> 4}, RimPiece{u, v, vi, vj, z, 0.0F});
    at->second.low = std::min(at->second.low, z);
    if (std::pair(vi, vj) < std::pair(at->second.void_i, at->second.void_j)) at->second.void_i = vi, at->second.void_j = vj;
    if (!fresh) continue;
    std::vector<double> heights;
    for (size_t q = 0; q < b.size(); ++q) {
      const double d = std::hypot(b.x[q] - ((u + 0.5) * side - b.origin.x()), b.y[q] - ((v + 0.5) * side - b.origin.y()));
      if (b.classification[q] == core::point_class::ground && d >= 3.0 && d <= 6.0) heights.push_back(b.origin.z() + b.z[q]);
    }
    at->second.behind = heights.size() < 5 ? std::nanf("") : static_cast<float>(core::median(heights));
  }
  std::vector<RimPiece> out;
  for (const auto& [key, piece] : pieces) out.push_back(piece);
  return out;
}

TEST(VoidRims, PiecesOfADenseCloudAreThoseOfTheDefinition) {
  // 70 returns per square metre: thousands lie behind each piece. Two voids, one of them with a return alone in it.
  const PulseSpacing s{0.12, 0.12};
  core::Block b;
  b.origin = {1000.0, 2000.0, 50.0};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 18.0);
  std::normal_distribution<double> error(0.0, 0.3);
  for (int k = 0; k < 22000; ++k) {
    const double x = place(random), y = place(random);
    if ((std::hypot(x - 6.0, y - 9.0) < 1.5 && k > 0) || (std::abs(x - 13.0) < 1.0 && std::abs(y - 4.0) < 0.5)) continue;
    b.x.push_back(k > 0 ? x : 6.0), b.y.push_back(k > 0 ? y : 9.0), b.z.push_back(std::floor(0.2 * x) + error(random));
    b.return_number.push_back(1), b.return_count.push_back(1), b.flags.push_back(0), b.strip.push_back(1);
    b.classification.push_back(k % 5 > 0 ? core::point_class::ground : core::point_class::building);
  }
  const std::vector<VoidRun> runs = find_voids(b, core::lattice_of(void_cell(s), 1000.0, 2000.0, 1018.0, 2018.0), s);
  const std::vector<RimPiece> found = rims_of(b, runs, s), expected = pieces_by_definition(b, runs, s);
  ASSERT_GT(found.size(), 20u);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t k = 0; k < found.size(); ++k) {
    const RimPiece &p = found[k], &e = expected[k];
    EXPECT_EQ(std::tuple(p.i, p.j, p.void_i, p.void_j, p.low), std::tuple(e.i, e.j, e.void_i, e.void_j, e.low)) << k;
    EXPECT_TRUE(p.behind == e.behind || (std::isnan(p.behind) && std::isnan(e.behind))) << k << " " << p.behind << " " << e.behind;
  }
}

TEST(VoidRims, FewPiecesOrNoGroundBehindSayNothing) {
  std::vector<RimPiece> rim;
  for (int k = 0; k < 7; ++k) rim.push_back({k, 0, k, 0, 1.0F, 2.0F});
  EXPECT_FALSE(is_shore(rim));
  rim.push_back({7, 0, 7, 0, 1.0F, 2.0F});
  EXPECT_TRUE(is_shore(rim));
  rim[3].behind = std::nanf("");
  EXPECT_FALSE(is_shore(rim));
  EXPECT_FALSE(is_shore({}));
}

}  // namespace
}  // namespace swath::quality
