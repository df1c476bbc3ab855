// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/repeated_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "core/time.h"
#include "quality/pulse_density.h"

namespace swath::quality {
namespace {

constexpr double side = 200.0;

/// First returns at 2 per m2 in steps of `scale`, with a second return each fifth.
core::Block cloud(double scale, bool has_times) {
  core::Block b;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> steps(0, static_cast<int>(side / scale) - 1), intensity(0, 4000);
  const auto n = static_cast<int>(2.0 * side * side);
  for (int k = 0; k < n; ++k)
    for (int number = 1; number <= (k % 5 == 0 ? 2 : 1); ++number) {
      b.x.push_back(scale * steps(random)), b.y.push_back(scale * steps(random)), b.z.push_back(0.0);
      b.time.push_back(has_times ? 1e-5 * (k + 1) : 0.0);
      b.intensity.push_back(static_cast<std::uint16_t>(intensity(random)));
      b.return_number.push_back(static_cast<std::uint8_t>(number));
      b.return_count.push_back(static_cast<std::uint8_t>(k % 5 == 0 ? 2 : 1));
      b.strip.push_back(static_cast<std::uint16_t>(1 + k % 2));
      b.flags.push_back(0);
    }
  return b;
}

/// The rows with x in the range, once more, off by rounding errors.
std::size_t repeat(core::Block& b, double x0, double x1) {
  std::vector<std::uint32_t> rows;
  std::size_t first = 0;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (b.x[p] >= x0 && b.x[p] < x1) rows.push_back(p), first += b.return_number[p] == 1;
  core::Block copy = core::select(b, rows);
  for (double& x : copy.x) x += 1e-9;
  core::append(b, copy);
  return first;
}

std::size_t count(const std::vector<std::uint8_t>& repeated) {
  return static_cast<std::size_t>(std::count(repeated.begin(), repeated.end(), 1));
}

SwathDensity density_of(const core::Block& b, double tile) {
  PulseCells all;
  for (double x = 0.0; x < side; x += tile) {
    const PulseCells part = count_pulses(b, core::lattice_of(5.0, x, -20.0, x + tile, side + 20.0), repeated_first_returns(b));
    all.lines.insert(all.lines.end(), part.lines.begin(), part.lines.end());
    all.bins.insert(all.bins.end(), part.bins.begin(), part.bins.end());
  }
  return judge_density(all.lines, all.bins, 5.0);
}

TEST(RepeatedReturns, TheBuffersOfTilesCountOnce) {
  for (const double scale : {0.001, 0.00025, 0.01 * 0.3048}) {
    core::Block b = cloud(scale, true);
    const SwathDensity once = density_of(b, side);
    EXPECT_EQ(once.duplicates, 0u);
    EXPECT_TRUE(repeated_first_returns(b).empty());
    const std::size_t n = repeat(b, 50.0, 80.0);
    const SwathDensity twice = density_of(b, side);
    EXPECT_EQ(twice.duplicates, n) << scale;
    EXPECT_EQ(twice.all.pulses, once.all.pulses);
    EXPECT_EQ(twice.all.density, once.all.density);
    EXPECT_NEAR(twice.duplicate_share, static_cast<double>(n) / static_cast<double>(once.all.pulses + n), 1e-12);
    const SwathDensity tiled = density_of(b, 40.0);
    EXPECT_EQ(tiled.duplicates, n) << "each is counted in one tile";
    EXPECT_EQ(tiled.all.density, twice.all.density);
  }
}

TEST(RepeatedReturns, TheOrderChangesNothing) {
  core::Block b = cloud(0.001, true);
  const std::size_t all = b.size();
  EXPECT_GT(repeat(b, 50.0, 80.0), 0u);
  for (std::size_t p = all; p < b.size(); ++p) b.strip[p] = 9;  // the copies are a line of their own
  std::vector<std::uint32_t> rows(b.size());
  std::iota(rows.rbegin(), rows.rend(), 0u);
  const SwathDensity a = density_of(b, side), c = density_of(core::select(b, rows), side);
  EXPECT_EQ(a.duplicates, c.duplicates);
  ASSERT_EQ(a.lines.size(), c.lines.size());
  for (std::size_t k = 0; k < a.lines.size(); ++k) EXPECT_EQ(a.lines[k].pulses, c.lines[k].pulses);
}

TEST(RepeatedReturns, AnotherTimeOrNumberIsAnotherReturn) {
  core::Block b = cloud(0.001, true);
  const std::size_t all = b.size();
  repeat(b, 0.0, side);
  for (std::size_t p = all; p < b.size(); ++p) b.time[p] += 1.0;
  EXPECT_TRUE(repeated_first_returns(b).empty());
}

/// Steps of 1 m: most first returns share their place with another one, with an intensity of their own.
TEST(RepeatedReturns, WithoutTimesOnlyWholeRecordsAreTheSame) {
  core::Block b = cloud(1.0, false);
  for (std::size_t p = 0; p < b.size(); ++p) b.intensity[p] = static_cast<std::uint16_t>(p), b.user_data.push_back(p > 65535);
  EXPECT_TRUE(repeated_first_returns(b).empty());
  const std::size_t n = repeat(b, 50.0, 80.0);
  EXPECT_EQ(count(repeated_first_returns(b)), n);
  b.time.assign(b.size(), core::adjusted_offset);  // a file of adjusted standard time without times
  EXPECT_EQ(count(repeated_first_returns(b)), n);
  b.intensity[b.size() - 1] ^= 1;
  EXPECT_EQ(count(repeated_first_returns(b)), n - 1);
  b.intensity[b.size() - 1] ^= 1;
  b.time.clear();
  EXPECT_EQ(count(repeated_first_returns(b)), n);
}

TEST(RepeatedReturns, WithheldPointsAndNoiseAreNotLookedAt) {
  core::Block b = cloud(0.001, true);
  const std::size_t all = b.size();
  repeat(b, 0.0, side);
  for (std::size_t p = all; p < b.size(); ++p) b.flags[p] = core::flag::withheld;
  EXPECT_TRUE(repeated_first_returns(b).empty());
  EXPECT_TRUE(repeated_first_returns(core::Block()).empty());
}

}  // namespace
}  // namespace swath::quality
