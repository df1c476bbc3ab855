// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/surface_difference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/relief.h"

namespace swath::quality {
namespace {

constexpr core::Lattice cells{1.0, 0, 0, 60, 40};

/// Level to the west, 15 deg steep to the east; void in the north.
core::Grid model(const core::Lattice& l) {
  core::Grid g(l);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      if (l.centre_y(j) > 38) continue;
      g.height[l.at(i, j)] = static_cast<float>(100.0 + std::max(0.0, l.centre_x(i) - 30.0) * std::tan(0.2618));
      g.reason[l.at(i, j)] = core::Void::none;
    }
  return g;
}

/// One return a cell: ground, but trees to the south, roofs in a corner, nothing seen of the ground in another.
core::Block returns() {
  core::Block b;
  for (int j = 0; j < cells.ny; ++j)
    for (int i = 0; i < cells.nx; ++i) {
      const auto add = [&](std::uint8_t kind) {
        b.x.push_back(i + 0.5), b.y.push_back(j + 0.5), b.z.push_back(0.0);
        b.classification.push_back(kind), b.flags.push_back(0);
      };
      if (i < 5 && j < 5)
        add(core::point_class::building);
      else if (i >= 55 && j < 5)
        add(core::point_class::high_vegetation);
      else
        add(core::point_class::ground);
      if (j < 10 && i >= 5 && i < 55) add(core::point_class::high_vegetation);
    }
  return b;
}

double dz(double x) { return x < 30 ? 0.10 : -0.20; }

SurfaceComparison compared(SurfaceDifference* kept = nullptr) {
  const core::Grid around = model({1.0, -1, -1, 62, 42}), own = model(cells);
  SurfaceDifference d = compare_surface(own, core::slope(around, cells), covers_of(returns(), cells), [&](double x, double y) {
    return y > 30 ? std::nan("") : 100.0 + std::max(0.0, x - 30.0) * std::tan(0.2618) - dz(x);
  });
  if (kept) *kept = d;
  return judge_surface(d.sums, d.bins);
}

const SurfaceClass* find(const SurfaceComparison& c, const std::string& slope, const std::string& cover) {
  for (const SurfaceClass& one : c.classes)
    if (one.slope == slope && one.cover == cover) return &one;
  return nullptr;
}

TEST(SurfaceDifference, BySlopeAndCover) {
  SurfaceDifference d;
  const SurfaceComparison c = compared(&d);
  EXPECT_EQ(d.not_compared, 60u * 8u);
  EXPECT_EQ(find(c, "all", "all")->errors.n, 60u * 30u);
  EXPECT_EQ(find(c, "all", "building")->errors.n, 25u);
  EXPECT_EQ(find(c, "all", "no ground return")->errors.n, 25u);
  EXPECT_EQ(find(c, "all", "vegetation")->errors.n, 500u);
  EXPECT_NEAR(find(c, "0 to 5", "all")->errors.median, 0.10, 1e-3);
  EXPECT_NEAR(find(c, "10 to 20", "all")->errors.mean, -0.20, 2e-3);
  EXPECT_NEAR(find(c, "10 to 20", "open")->errors.q95, 0.20, 2e-3);
  EXPECT_NEAR(find(c, "all", "all")->errors.rms, std::sqrt(0.5 * (0.01 + 0.04)), 2e-3);
  EXPECT_EQ(find(c, "over 30", "all"), nullptr);
  EXPECT_NEAR(static_cast<double>(d.difference.height[cells.at(10, 20)]), 0.10, 1e-4);
  EXPECT_EQ(d.difference.reason[cells.at(10, 35)], core::Void::no_data);
  double all = 0.0;
  for (const double n : c.bin_cells) all += n;
  EXPECT_EQ(all, 1800.0);
}

TEST(SurfaceDifference, ClassesOfSlope) {
  EXPECT_EQ(slope_class_of(0.0), 0);
  EXPECT_EQ(slope_class_of(5.0), 0);
  EXPECT_EQ(slope_class_of(5.1), 1);
  EXPECT_EQ(slope_class_of(80.0), 4);
  EXPECT_EQ(slope_name(0), "0 to 5");
  EXPECT_EQ(slope_name(3), "20 to 30");
  EXPECT_EQ(slope_name(4), "over 30");
}

TEST(SurfaceDifference, OfNothingIsEmpty) { EXPECT_TRUE(judge_surface({}, {}).classes.empty()); }

}  // namespace
}  // namespace swath::quality
