// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/residual_bins.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::calib {
namespace {

calib::GroupResidual group(std::uint32_t line, double angle_deg, double before, double after, std::uint32_t returns, double rms) {
  calib::GroupResidual g;
  g.line = line;
  g.angle = angle_deg * core::degree;
  g.range = 700.0;
  g.time = 1000.0 + 10.0 * line;
  g.before = before;
  g.after = after;
  g.returns = returns;
  g.rms = rms;
  g.w = after / 0.01;
  return g;
}

struct Flight {
  calib::TieSet ties;
  calib::Adjustment adjustment;
};

/// Lines 4 and 9; three groups of line 4, one of them taken out, and one of line 9.
Flight flight() {
  Flight f;
  f.ties.lines = {{4, 1000.0, 1005.0}, {9, 1010.0, 1015.0}};
  f.ties.groups = {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 0, 0}};
  f.adjustment.groups = {group(0, -12, 0.10, 0.01, 100, 0.02), group(0, 3, -0.20, -0.03, 300, 0.03), group(0, 4, 0.5, 0.4, 50, 0.4),
                         group(1, 27, 0.04, 0.02, 50, 0.02)};
  f.adjustment.groups[2].rejected = true;
  return f;
}

TEST(ResidualBins, ByLineByHand) {
  const Flight f = flight();
  const auto bins = residual_bins(f.adjustment, f.ties, BinBy::line);
  ASSERT_EQ(bins.size(), 2u);
  const ResidualBin& b = bins[0];
  EXPECT_EQ(b.low, 4.0);
  EXPECT_EQ(b.high, 4.0);
  EXPECT_EQ(b.groups, 2u);
  EXPECT_EQ(b.rejected, 1u);
  EXPECT_EQ(b.returns, 400u);
  EXPECT_DOUBLE_EQ(b.mean_before, -0.05);
  EXPECT_DOUBLE_EQ(b.rms_before, std::sqrt((0.01 + 0.04) / 2));
  EXPECT_DOUBLE_EQ(b.mean_after, -0.01);
  EXPECT_DOUBLE_EQ(b.rms_after, std::sqrt((0.0001 + 0.0009) / 2));
  EXPECT_DOUBLE_EQ(b.rms_returns, std::sqrt((100 * 0.0004 + 300 * 0.0009) / 400));
  EXPECT_DOUBLE_EQ(b.largest_w, 3.0);
  EXPECT_EQ(bins[1].low, 9.0);
}

TEST(ResidualBins, EveryGroupLiesInOneBin) {
  const Flight f = flight();
  for (const BinBy by : {BinBy::angle, BinBy::range, BinBy::time, BinBy::line}) {
    std::uint64_t held = 0;
    const auto bins = residual_bins(f.adjustment, f.ties, by);
    EXPECT_LE(bins.size(), 10u);
    for (const ResidualBin& b : bins) {
      held += b.groups + b.rejected;
      for (const auto& g : f.adjustment.groups)
        if (by != BinBy::line && bins.size() == 1) {
          EXPECT_GE(bin_value(g, f.ties, by), b.low);
          EXPECT_LT(bin_value(g, f.ties, by), b.high);
        }
    }
    EXPECT_EQ(held, f.adjustment.groups.size());
  }
  // -12 to 27 deg in steps of 5.
  const auto angles = residual_bins(f.adjustment, f.ties, BinBy::angle);
  EXPECT_DOUBLE_EQ(angles.front().low, -15.0);
  EXPECT_DOUBLE_EQ(angles.back().high, 30.0);
  EXPECT_EQ(angles.size(), 3u);
}

TEST(ResidualBins, GroupsTakenOutAreInNoMeasure) {
  Flight f = flight();
  for (auto& g : f.adjustment.groups) g.rejected = true;
  const ResidualBin all = residual_total(f.adjustment);
  EXPECT_EQ(all.groups, 0u);
  EXPECT_EQ(all.rejected, 4u);
  EXPECT_TRUE(std::isnan(all.mean_after) && std::isnan(all.rms_before) && std::isnan(all.rms_returns) && std::isnan(all.largest_w));
}

TEST(ResidualBins, AnUnknownStartIsInNoMeanOfTheStart) {
  Flight f = flight();
  f.adjustment.groups[0].before = calib::not_known;
  EXPECT_DOUBLE_EQ(residual_bins(f.adjustment, f.ties, BinBy::line)[0].mean_before, -0.20);
  EXPECT_TRUE(residual_bins({}, f.ties, BinBy::time).empty());
}

TEST(ResidualBins, PlanesAreCountedOnce) {
  const Flight f = flight();
  EXPECT_EQ(planes_of(f.ties, 4), 3u);
  EXPECT_EQ(planes_of(f.ties, 9), 1u);  // seen ahead and behind
  EXPECT_EQ(common_planes(f.ties, 4, 9), 1u);
  EXPECT_EQ(common_planes(f.ties, 4, 5), 0u);
  EXPECT_EQ(first_time(f.ties), 1000.0);
}

TEST(ResidualBins, DifferencesPassOverVoids) {
  core::Grid g(core::Lattice{1.0, 0, 0, 3, 1});
  g.height[0] = 0.3f;
  g.height[2] = -0.1f;
  const report::Statistics s = difference_statistics(g);
  EXPECT_EQ(s.n, 2u);
  EXPECT_EQ(s.skipped, 0u);
  EXPECT_NEAR(s.mean, 0.1, 1e-7);  // heights are floats
}

}  // namespace
}  // namespace swath::calib
