// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr double half_angle = 20 * M_PI / 180;
const Ring area{{-300, 0}, {300, 0}, {300, 1000}, {-300, 1000}};
const FlightLine north{"line 1", {0, -100}, {0, 1100}, 700};

Beam beam(ScanPattern pattern = ScanPattern::triangle) { return {pattern, 100e3, 60, half_angle, 0}; }

Coverage cover(const std::vector<FlightLine>& lines, const core::HeightField& ground, const Beam& b, double cell = 10) {
  return coverage_of(lines, {area}, ground, b, {}, {}, cell);
}

double total(const Coverage& c) {
  double sum = 0.0;
  for (const float d : c.density)
    if (std::isfinite(d)) sum += static_cast<double>(d) * c.lattice.cell * c.lattice.cell;
  return sum;
}

/// All pulses that are fired over the area come down in it.
TEST(Coverage, NoPulseIsLost) {
  for (const ScanPattern p : {ScanPattern::triangle, ScanPattern::sine, ScanPattern::polygon})
    EXPECT_NEAR(total(cover({north}, core::HeightField(0), beam(p))), 100e3 * 1000 / 60, 2e-3 * 100e3 * 1000 / 60);
}

TEST(Coverage, TwoLinesAreTwice) {
  FlightLine back = north;
  std::swap(back.from, back.to);
  const Coverage one = cover({north}, core::HeightField(0), beam()), two = cover({north, back}, core::HeightField(0), beam());
  EXPECT_NEAR(total(two), 2 * total(one), 1e-3 * total(one));
  EXPECT_NEAR(static_cast<double>(two.lines[two.lattice.at(30, 50)]), 2.0, 1e-6);
}

/// Against pulses that are fired one by one, at an even spread of angles, onto a rolling ground, cell by cell.
TEST(Coverage, IsWhatPulsesDo) {
  const int n = 160;
  std::vector<float> z;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) z.push_back(static_cast<float>(60 * std::sin((10.0 * i - 400) / 90) + 40 * std::cos(10.0 * j / 130)));
  const core::HeightField ground({-400, -300, 10, 10, n, n}, z);
  const Coverage c = cover({north}, ground, beam(), 25);
  std::vector<double> counted(c.lattice.size(), 0.0);
  constexpr int pulses = 1500000;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even(0, 1);
  for (int k = 0; k < pulses; ++k) {
    const double y = -100 + 1200 * even(random), angle = half_angle * (2 * even(random) - 1);
    double range = 0;
    while (700 - range * std::cos(angle) > ground.height(range * std::sin(angle), y)) range += 4;
    double low = range - 4, high = range;
    for (int b = 0; b < 14; ++b) {
      const double m = 0.5 * (low + high);
      (700 - m * std::cos(angle) > ground.height(m * std::sin(angle), y) ? low : high) = m;
    }
    const std::int64_t i = core::cell_index(low * std::sin(angle), 25) - c.lattice.i0, j = core::cell_index(y, 25) - c.lattice.j0;
    if (i >= 0 && j >= 0 && i < c.lattice.nx && j < c.lattice.ny) counted[c.lattice.at(static_cast<int>(i), static_cast<int>(j))] += 1;
  }
  const double pulses_per_metre = 100e3 / 60, weight = pulses_per_metre * 1200 / pulses / 625;
  int compared = 0, near = 0;
  for (size_t k = 0; k < counted.size(); ++k) {
    if (!std::isfinite(c.density[k]) || c.lines[k] < 0.999f) continue;
    ++compared;
    if (std::abs(static_cast<double>(c.density[k]) / (counted[k] * weight) - 1) < 0.1) ++near;
  }
  EXPECT_GT(compared, 500);
  EXPECT_GT(near, 0.98 * compared);
}

/// A ridge hides the ground behind it.
TEST(Coverage, BehindARidgeNothingIsSeen) {
  const int n = 120;
  std::vector<float> z;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) z.push_back(i == 80 ? 300.0f : 0.0f);  // at x = 200
  const Coverage c = cover({north}, core::HeightField({-600, -100, 10, 10, n, n}, z), beam());
  EXPECT_EQ(c.density[c.lattice.at(51, 50)], 0.0f);  // x = 215: shaded by the ridge
  EXPECT_GT(c.density[c.lattice.at(47, 50)], 0.0f);  // x = 175
  EXPECT_TRUE(std::isnan(c.sigma_height[c.lattice.at(51, 50)]));
}

TEST(Coverage, BeyondTheRangeNothingIsSeen) {
  Beam b = beam();
  b.max_range = 720;
  const Coverage c = cover({north}, core::HeightField(0), b);
  EXPECT_GT(c.density[c.lattice.at(30, 50)], 0.0f);
  EXPECT_EQ(c.density[c.lattice.at(52, 50)], 0.0f);  // x = 225: 735 m away
}

/// At nadir the ranging error and the height of the trajectory, on a slope the place too.
TEST(Coverage, SigmaGrowsWithTheSlope) {
  const int n = 120;
  std::vector<float> level(static_cast<size_t>(n) * n, 0.0f), slope;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) slope.push_back(static_cast<float>(0.5 * (10 * i - 600)));
  const Coverage flat = cover({north}, core::HeightField({-600, -100, 10, 10, n, n}, level), beam());
  const Coverage steep = cover({north}, core::HeightField({-600, -100, 10, 10, n, n}, slope), beam());
  const core::SensorSigma s;
  const TrajectorySigma t;
  const size_t nadir = flat.lattice.at(30, 50);
  const ErrorBudget b = error_budget(sources_of(s, t, 700, 0, 60), 700, 0);
  EXPECT_NEAR(static_cast<double>(flat.sigma_height[nadir]), b.total().z(), 5e-3 * b.total().z());
  EXPECT_NEAR(static_cast<double>(steep.sigma_height[nadir]), std::hypot(b.total().z(), 0.5 * b.total().y()), 0.02 * b.total().y());
}

}  // namespace
}  // namespace swath::planning
