// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/window_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace swath::calib {
namespace {

using Surface = std::function<double(double, double)>;

/// Means over cells, of samples within each.
Raster raster_of(const Surface& z, int nx, int ny, double x0, double y0, double noise = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  Raster r{nx, ny, {}};
  constexpr int fine = 8;
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      double sum = 0.0;
      for (int v = 0; v < fine; ++v)
        for (int u = 0; u < fine; ++u) sum += z(x0 + x + (u + 0.5) / fine, y0 + y + (v + 0.5) / fine);
      r.z.push_back(static_cast<float>(sum / (fine * fine) + noise * normal(random)));
    }
  return r;
}

double houses(double x, double y) {
  const auto house = [&](double cx, double cy, double hx, double hy, double azimuth) {
    const double u = std::cos(azimuth) * (x - cx) + std::sin(azimuth) * (y - cy),
                 v = -std::sin(azimuth) * (x - cx) + std::cos(azimuth) * (y - cy);
    return std::abs(u) < hx && std::abs(v) < hy ? 6.0 - 0.4 * std::abs(v) : 0.0;
  };
  return house(14, 18, 8, 5, 0.4) + house(40, 30, 6, 9, 1.0) + house(22, 48, 10, 4, 2.1);
}

TEST(WindowMatch, ReliefIsWhatNeighboursShare) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 12.0);
  const auto built = relief_of(raster_of(houses, 64, 64, 0, 0));
  ASSERT_TRUE(built);
  EXPECT_GT(built->shared, 0.7 * built->rms);
  EXPECT_GT(built->rms, 1.0);
  const auto tilted = relief_of(raster_of([](double x, double y) { return 3.0 + 0.2 * x - 0.1 * y; }, 64, 64, 0, 0));
  ASSERT_TRUE(tilted);
  EXPECT_LT(tilted->rms, 1e-4) << "a plane is no relief";
  Raster wood{64, 64, std::vector<float>(64 * 64)};
  for (float& z : wood.z) z = static_cast<float>(uniform(random));
  const auto trees = relief_of(wood);
  ASSERT_TRUE(trees);
  EXPECT_GT(trees->rms, 3.0);
  EXPECT_LT(trees->shared, 0.3 * trees->rms);
  for (size_t c = 0; c < wood.z.size(); ++c)
    if (c % 3) wood.z[c] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(relief_of(wood)) << "a third of the cells is too little";
}

TEST(WindowMatch, AWholeShiftIsMetExactly) {
  constexpr int margin = 6;
  const Raster a = raster_of(houses, 60, 60, 0, 0);
  // b(x) = a(x - (3, -2)) + 0.7 + tilt
  const Raster b = raster_of([](double x, double y) { return houses(x - 3, y + 2) + 0.7 + 0.01 * (x - 33.0) - 0.005 * (y - 28.0); },
                             60 + 2 * margin, 60 + 2 * margin, -margin, -margin);
  const auto f = fit_shift(a, b, margin, margin, 3, -2);
  ASSERT_TRUE(f);
  constexpr double single_precision = 1e-6;
  EXPECT_LT(f->cost, single_precision);
  EXPECT_NEAR(f->rise, 0.7, 1e-4);
  EXPECT_EQ(f->cells, 3600);
  const auto off = fit_shift(a, b, margin, margin, 0, 0);
  ASSERT_TRUE(off);
  EXPECT_GT(off->cost, 0.2);
  const ShiftCosts costs = shift_costs(a, b, margin, margin, {});
  EXPECT_LT(costs(3.0, -2.0), 1e-4);
  EXPECT_GT(costs(-3.0, 2.0), 0.5);
  EXPECT_EQ(costs(margin + 0.5, 0.0), 1.0) << "beyond the margin nothing is known";
}

TEST(WindowMatch, ShiftsBetweenCellsAreFoundWithinTheirSigma) {
  constexpr int margin = 5;
  constexpr double noise = 0.05;  // m
  double squares = 0.0, formal = 0.0;
  int n = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const double dx = -2.0 + 0.37 * seed, dy = 1.7 - 0.29 * seed;
    const Raster a = raster_of(houses, 60, 60, 0, 0, noise, 2 * seed);
    const Raster b = raster_of([&](double x, double y) { return houses(x - dx, y - dy) + 0.3; }, 60 + 2 * margin, 60 + 2 * margin, -margin,
                               -margin, noise, 2 * seed + 1);
    const ShiftCosts costs = shift_costs(a, b, margin, margin, {});
    const auto s = subcell_shift(a, b, costs, {std::round(dx), std::round(dy)}, 3);
    ASSERT_TRUE(s) << seed;
    squares += (s->shift - Eigen::Vector2d(dx, dy)).squaredNorm();
    formal += s->covariance.trace();
    n += 2;
    EXPECT_NEAR(s->rise, 0.3, 4.0 * std::sqrt(s->rise_variance));
    EXPECT_LT(s->share, 0.5);
  }
  constexpr double good = 0.12;  // cells: a tenth is what a quadric over means keeps
  EXPECT_LT(std::sqrt(squares / n), good);
  EXPECT_LT(squares / formal, 4.0) << "the covariance must not flatter";
}

TEST(WindowMatch, NothingIsFoundWithoutABottom) {
  constexpr int margin = 4;
  const Raster a = raster_of([](double, double) { return 1.0; }, 40, 40, 0, 0);
  const Raster b = raster_of([](double, double) { return 1.0; }, 48, 48, 0, 0);
  const ShiftCosts costs = shift_costs(a, b, margin, margin, {});
  const auto s = subcell_shift(a, b, costs, {0, 0}, 3);
  if (s) {
    EXPECT_GT(s->covariance.trace(), 1.0) << "level ground tells no shift";
  }
  // The true shift lies beyond what was looked at: the lowest cost is on the rim.
  const Raster c = raster_of(houses, 60, 60, 0, 0),
               d = raster_of([](double x, double y) { return houses(x - 9, y); }, 68, 68, -margin, -margin);
  const ShiftCosts rim = shift_costs(c, d, margin, margin, {});
  EXPECT_FALSE(subcell_shift(c, d, rim, {margin, 0}, 2));
}

}  // namespace
}  // namespace swath::calib
