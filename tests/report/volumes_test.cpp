// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/volumes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::report {
namespace {

using Surface = std::function<double(double, double)>;

core::Grid sampled(const core::Lattice& l, const Surface& surface, float sigma = 0.0f) {
  core::Grid g(l);
  g.sigma.assign(l.size(), sigma);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      g.height[l.at(i, j)] = static_cast<float>(surface(l.centre_x(i), l.centre_y(j)));
      g.reason[l.at(i, j)] = core::Void::none;
    }
  return g;
}

const Surface ground = [](double x, double y) { return 100.0 + 0.03 * x - 0.02 * y; };
const core::Lattice field{0.5, 1000, 2000, 240, 200};  // 120 m by 100 m from (500, 1000)

/// Of a heap on 0.5 m cells the midpoint rule misses its rim, where the slope breaks.
constexpr double body_tolerance = 1e-3;

TEST(Volumes, KnownBodies) {
  const double cx = 560.1, cy = 1050.2;
  const auto r = [=](double x, double y) { return std::hypot(x - cx, y - cy); };
  struct Body {
    const char* name;
    Surface height;
    double volume;
  };
  const Body bodies[] = {
      {"cone", [=](double x, double y) { return std::max(0.0, 10.0 - 0.5 * r(x, y)); }, core::pi * 400.0 * 10.0 / 3.0},
      {"paraboloid", [=](double x, double y) { return std::max(0.0, 8.0 - 0.02 * r(x, y) * r(x, y)); }, core::pi * 400.0 * 8.0 / 2.0},
      {"half ball", [=](double x, double y) { return std::sqrt(std::max(0.0, 900.0 - r(x, y) * r(x, y))); },
       2.0 / 3.0 * core::pi * 27000.0}};
  const core::Grid before = sampled(field, ground);
  for (const Body& b : bodies) {
    const core::Grid after = sampled(field, [&](double x, double y) { return ground(x, y) + b.height(x, y); });
    const Volumes heap = volumes(before, after, 1.0, 1.0), pit = volumes(after, before, 1.0, 1.0);
    EXPECT_NEAR(heap.fill, b.volume, body_tolerance * b.volume) << b.name;
    EXPECT_NEAR(heap.cut, 0.0, 0.05) << b.name;  // rounding of heights to float
    EXPECT_NEAR(pit.cut, heap.fill, 1e-6);
    EXPECT_NEAR(heap.net, heap.fill - heap.cut, 1e-6);
    EXPECT_NEAR(heap.area, 12000.0, 1e-9);
    EXPECT_EQ(heap.left_out, 0u);
  }
}

TEST(Volumes, CutAndFillToADesignHeight) {
  // A plane of 2 m relief across 100 m levelled at its middle: half a wedge each, 1 m high, 50 m long, 50 m wide.
  const core::Grid before = sampled({1.0, 0, 0, 50, 100}, [](double, double y) { return 0.02 * y; });
  const core::Grid design = sampled(before.lattice, [](double, double) { return 1.0; });
  const Volumes v = volumes(before, design, 1.0, 0.0);
  EXPECT_NEAR(v.cut, 0.5 * 50.0 * 1.0 * 50.0, 1e-3);
  EXPECT_NEAR(v.fill, v.cut, 1e-3);
  EXPECT_NEAR(v.cut_area, 2500.0, 1e-9);
}

TEST(Volumes, APolygonCountsWithItsExactArea) {
  const core::Grid before = sampled(field, ground), after = sampled(field, [](double x, double y) { return ground(x, y) + 2.0; });
  const Ring triangle{{510.13, 1010.21}, {590.77, 1020.4}, {540.3, 1080.9}};
  const double area = 0.5 * ((590.77 - 510.13) * (1080.9 - 1010.21) - (1020.4 - 1010.21) * (540.3 - 510.13));
  const Volumes one = volumes(before, after, 1.0, 1.0, {triangle});
  EXPECT_NEAR(one.area, area, 1e-6);
  EXPECT_NEAR(one.fill, 2.0 * area, 2e-5 * area);
  const Ring hole{{530, 1030}, {530, 1040}, {545, 1040}, {545, 1030}};
  EXPECT_NEAR(volumes(before, after, 1.0, 1.0, {triangle, hole}).area, area - 150.0, 1e-6);
  const Ring crescent{{510, 1010}, {580, 1010}, {580, 1080}, {510, 1080}, {510, 1060}, {560, 1060}, {560, 1030}, {510, 1030}};
  EXPECT_NEAR(volumes(before, after, 1.0, 1.0, {crescent}).area, 70.0 * 70.0 - 50.0 * 30.0, 1e-6);
  const Ring beyond{{0, 0}, {10000, 0}, {10000, 10000}, {0, 10000}};
  EXPECT_NEAR(volumes(before, after, 1.0, 1.0, {beyond}).area, 12000.0, 1e-6);
}

/// Whatever vertex its ring begins with, a neighbour is no hole; nor is a polygon that overlaps in part.
TEST(Volumes, NeighboursCountBoth) {
  const core::Lattice l{1.0, 0, 0, 60, 40};
  const auto total = [&](const std::vector<Ring>& polygon) {
    double sum = 0.0;
    for (const double s : shares_inside(l, polygon)) sum += s;
    return sum;
  };
  const Ring west{{10, 10}, {30, 10}, {30, 30}, {10, 30}}, east{{30, 10}, {50, 10}, {50, 30}, {30, 30}};
  const Ring inner{{35, 15}, {45, 15}, {45, 25}, {35, 25}}, over{{20, 20}, {26, 20}, {26, 36}, {20, 36}},
      corner{{30, 10}, {34, 10}, {34, 14}, {30, 14}};
  for (size_t turn = 0; turn < 4; ++turn) {
    const auto turned = [&](Ring r, bool back) {
      std::rotate(r.begin(), r.begin() + static_cast<std::ptrdiff_t>(turn), r.end());
      if (back) std::reverse(r.begin(), r.end());
      return r;
    };
    for (const bool back : {false, true}) {
      EXPECT_NEAR(total({turned(west, back), east}), 800.0, 1e-9) << turn;
      EXPECT_NEAR(total({west, turned(east, back)}), 800.0, 1e-9) << turn;
      EXPECT_NEAR(total({west, east, turned(inner, back)}), 700.0, 1e-9) << turn;
      EXPECT_NEAR(total({west, turned(over, back)}), 400.0 + 6.0 * 6.0, 1e-9) << turn;
      EXPECT_NEAR(total({east, turned(corner, back)}), 400.0 - 16.0, 1e-9) << "a hole in the corner " << turn;
    }
  }
}

TEST(Volumes, SigmaByTheStatedCorrelation) {
  const core::Lattice l{1.0, 0, 0, 20, 20};
  const core::Grid before = sampled(l, ground, 0.03f), after = sampled(
                                                           l, [](double x, double y) { return ground(x, y) + 1.0; }, 0.04f);
  EXPECT_NEAR(volumes(before, after, 1.0, 1.0).sigma_net, 400.0 * 0.05, 1e-5);  // one shift of each model
  EXPECT_NEAR(volumes(before, after, 1.0, 0.0).sigma_net, 20.0 * 0.05, 1e-5);   // noise: sqrt(n)
  EXPECT_NEAR(volumes(before, after, 1.0, 0.5).sigma_fill, 0.05 * std::sqrt(0.5 * 400 + 0.5 * 160000), 1e-4);
  core::Grid unknown = after;
  unknown.sigma.clear();
  EXPECT_TRUE(std::isnan(volumes(before, unknown, 1.0, 1.0).sigma_net));
}

TEST(Volumes, VoidCellsAreLeftOutAndCounted) {
  core::Grid before = sampled({1.0, 0, 0, 10, 10}, ground),
             after = sampled({1.0, 0, 0, 10, 10}, [](double x, double y) { return ground(x, y) - 1.0; });
  before.height[5] = std::nanf("");
  after.height[5] = after.height[77] = std::nanf("");
  const Volumes v = volumes(before, after, 1.0, 1.0);
  EXPECT_EQ(v.left_out, 1u);  // where both are void is outside of the matter, but not inside a polygon
  EXPECT_NEAR(v.cut, 98.0, 1e-3);
  EXPECT_NEAR(v.area_left_out, 1.0, 1e-12);
  const Ring all{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  EXPECT_EQ(volumes(before, after, 1.0, 1.0, {all}).left_out, 2u);
}

TEST(Volumes, OtherLatticesAreReadBilinearly) {
  const core::Grid coarse = sampled({2.0, 250, 500, 60, 50}, ground);
  const core::Grid fine = resampled(coarse, field);
  size_t known = 0;
  for (int j = 0; j < field.ny; ++j)
    for (int i = 0; i < field.nx; ++i) {
      const float h = fine.height[field.at(i, j)];
      if (std::isnan(h)) continue;
      ++known;
      ASSERT_NEAR(h, ground(field.centre_x(i), field.centre_y(j)), 1e-4);
    }
  EXPECT_EQ(known, 236u * 196u);  // all but the half coarse cell at the border
  EXPECT_THROW(volumes(coarse, fine, 1.0, 1.0), core::Error);
}

TEST(Volumes, BandsOfRowsAddUpToTheWhole) {
  core::Grid before(core::Lattice{1.0, 100, 200, 9, 10}), after = before;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 9; ++i) {
      const size_t at = before.lattice.at(i, j);
      before.height[at] = static_cast<float>(i);
      after.height[at] = static_cast<float>(j);
    }
  after.height[4] = std::nanf("");
  before.sigma.assign(90, 0.05f);
  after.sigma.assign(90, 0.02f);
  const std::vector<Ring> polygon{{{101.3, 200.2}, {108.1, 203.0}, {103.0, 209.7}}};
  const Volumes whole = volumes(before, after, 1.0, 0.3, polygon);
  VolumeSum sum(1.0, 0.3, polygon);
  const auto rows = [](const core::Grid& g, int first, int n) {
    core::Grid out(core::Lattice{1.0, 100, 200 + first, 9, n});
    out.sigma.resize(out.height.size());
    for (size_t k = 0; k < out.height.size(); ++k) {
      out.height[k] = g.height[k + static_cast<size_t>(9 * first)];
      out.sigma[k] = g.sigma[k + static_cast<size_t>(9 * first)];
    }
    return out;
  };
  for (const auto& [first, n] : {std::pair{0, 3}, {3, 1}, {4, 6}}) sum.add(rows(before, first, n), rows(after, first, n));
  const Volumes parts = sum.result();
  EXPECT_EQ(parts.net, whole.net);
  EXPECT_EQ(parts.sigma_net, whole.sigma_net);
  EXPECT_EQ(parts.sigma_cut, whole.sigma_cut);
  EXPECT_EQ(parts.cells, whole.cells);
  EXPECT_EQ(parts.left_out, whole.left_out);
  EXPECT_GT(whole.net, 0.0);
}

}  // namespace
}  // namespace swath::report
