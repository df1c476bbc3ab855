// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/outlier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/option_visitors.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

using test::add_point;

TEST(Outlier, ThresholdIsMeanAndDeviationsOfTheWindow) {
  // Points 1 m apart in a row, one 2.5 m above it; k = 1: distances are 1 but for that one.
  core::Block b;
  for (int k = 0; k < 30; ++k) add_point(b, k + 0.5, 0.5, 0.0);
  add_point(b, 15.5, 0.5, 2.5);
  OutlierOptions o;
  o.mean_k = 1;
  o.window = core::Metres(300.0);
  o.min_distance = core::Metres(0.0);
  o.reach = core::Metres(20.0);
  o.group = 0;
  const double mean = (30 * 1.0 + 2.5) / 31, deviation = std::sqrt((30 * 1.0 + 2.5 * 2.5) / 31 - mean * mean);
  const double exactly = (2.5 - mean) / deviation;
  for (const auto& [multiplier, found] : {std::pair{exactly - 0.01, 1u}, std::pair{exactly + 0.01, 0u}}) {
    core::Block tested = b;
    o.multiplier = multiplier;
    EXPECT_EQ(flag_outliers(tested, tested.size(), o).statistical, found);
  }
}

TEST(Outlier, BirdsAndMultipathGetTheirClassesAndScenesStay) {
  for (const std::string& name : test::scene_names()) {
    test::Scene s = test::make_scene(name);
    const size_t clean = s.block.size();
    std::vector<bool> high;
    const auto put = [&](double x, double y, double above) {
      add_point(s.block, x, y, s.terrain(x, y) + above);
      high.push_back(above > 0);
    };
    for (int k = 0; k < 8; ++k) put(20.0 + 20.0 * k, 15.0, 40.0);
    for (int k = 0; k < 8; ++k) put(20.0 + 20.0 * k, 25.0, -8.0);
    for (int k = 0; k < 6; ++k) put(30.0 + 0.7 * k, 30.0, 70.0);  // a flock
    flag_outliers(s.block, s.block.size(), {});
    size_t found = 0;
    for (size_t p = clean; p < s.block.size(); ++p)
      found += s.block.classification[p] == (high[p - clean] ? core::point_class::high_noise : core::point_class::low_noise);
    EXPECT_EQ(found, high.size()) << name;
  }
}

TEST(Outlier, OneInAThousandOfTheZooAtMost) {
  constexpr double bearable = 0.001;
  for (const std::string& name : test::scene_names()) {
    test::Scene s = test::make_scene(name);
    const OutlierCounts n = flag_outliers(s.block, s.block.size(), {});
    EXPECT_LE(static_cast<double>(n.low_noise + n.high_noise), bearable * static_cast<double>(s.block.size())) << name;
  }
}

TEST(Outlier, AWireOverDenseGroundStays) {
  test::Scene s = test::make_scene("flat");
  const size_t before = s.block.size();
  for (double x = 0.0; x < 200.0; x += 0.8) add_point(s.block, x, 80.0, 115.0);
  flag_outliers(s.block, s.block.size(), {});
  for (size_t p = before + 8; p + 8 < s.block.size(); ++p) EXPECT_EQ(s.block.classification[p], core::point_class::never_classified) << p;
}

TEST(Outlier, NoiseAndHaloKeepOut) {
  test::Scene s = test::make_scene("flat");
  add_point(s.block, 50.0, 50.0, 140.0);
  add_point(s.block, 60.0, 50.0, 140.0);
  add_point(s.block, 70.0, 50.0, 140.0);
  const size_t n = s.block.size();
  s.block.classification[n - 3] = core::point_class::low_noise;
  const OutlierCounts counts = flag_outliers(s.block, n - 1, {});
  EXPECT_EQ(counts.untouched, 1u);
  EXPECT_EQ(s.block.classification[n - 3], core::point_class::low_noise);
  EXPECT_EQ(s.block.classification[n - 2], core::point_class::high_noise);
  EXPECT_TRUE(s.block.flags[n - 2] & core::flag::isolated);
  EXPECT_EQ(s.block.classification[n - 1], core::point_class::never_classified);
  core::Block empty;
  EXPECT_EQ(flag_outliers(empty, 0, {}).high_noise, 0u);
}

TEST(Outlier, OptionsAreCheckedAgainstOneAnother) {
  OutlierOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["min_distance"] = "12 m";
  core::read_options(core::described(o), table, "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "min_distance must be less than reach");
}

}  // namespace
}  // namespace swath::filters
