// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy by check points: formulas by hand, classes of a map, and the table that is left of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stages/adapters/quality/mark_accuracy.h"
#include "stages/adapters/quality/mark_files.h"
#include "tests/stages/tile_work.h"

namespace swath::stages {
namespace {

struct Marks {
  std::vector<quality::CheckMark> list;
  std::vector<MarkFound> found;
  void add(const std::string& cover, double error, double sigma = 0.02) {
    const auto n = static_cast<double>(list.size());
    list.push_back({"p" + std::to_string(list.size() + 1), cover, "check.csv:2", {600000.0 + n, 5300000.0, 400.0}, sigma});
    found.push_back({error, std::nan(""), 0.03, 0.0, 0.0, false});
  }
};

const CoverAccuracy& of(const std::vector<CoverAccuracy>& list, const std::string& cover) {
  return *std::find_if(list.begin(), list.end(), [&](const auto& a) { return a.cover == cover && a.product == "points"; });
}

TEST(CheckPointAccuracy, TheMarksOwnErrorIsAddedAndTakenOff) {
  Marks m;
  for (const double e : {0.03, -0.05, 0.04, 0.00}) m.add("bare", e);
  for (const double e : {0.10, 0.20}) m.add("forest", e);
  const std::vector<CoverAccuracy> all = accuracy_of(m.list, m.found, {"bare"});
  EXPECT_EQ(all.size(), 5u);  // open, vegetated, all, and both covers by name
  const CoverAccuracy& open = of(all, open_cover);
  const double rms = std::sqrt((9.0 + 25.0 + 16.0) / 4.0) / 100.0;
  EXPECT_EQ(open.errors.n, 4u);
  EXPECT_NEAR(open.errors.rms, rms, 1e-12);
  EXPECT_NEAR(open.with_marks, std::sqrt(rms * rms + 0.02 * 0.02), 1e-12);
  EXPECT_NEAR(open.without_marks, std::sqrt(rms * rms - 0.02 * 0.02), 1e-12);
  EXPECT_NEAR(open.predicted, std::hypot(0.02, 0.03), 1e-12);
  EXPECT_FALSE(open.is_enough);
  EXPECT_NEAR(of(all, vegetated_cover).errors.mean, 0.15, 1e-12);
}

TEST(CheckPointAccuracy, ABiggerErrorOfTheMarksThanOfTheProductIsNegative) {
  Marks m;
  for (const double e : {0.01, -0.01, 0.01}) m.add("", e, 0.05);
  const auto all = accuracy_of(m.list, m.found, {""});
  EXPECT_NEAR(of(all, open_cover).without_marks, -std::sqrt(0.05 * 0.05 - 0.01 * 0.01), 1e-12);
}

/// Between the two values next to share (n - 1), as all quantiles of the table.
TEST(CheckPointAccuracy, NinetyPercentAreSmallerByTheSameRuleAsNinetyFive) {
  Marks m;
  for (int k = 1; k <= 11; ++k) m.add("", 0.01 * k);
  const auto all = accuracy_of(m.list, m.found, {""});
  EXPECT_NEAR(of(all, open_cover).q90, 0.10, 1e-12);
  EXPECT_NEAR(of(all, open_cover).errors.q95, 0.105, 1e-12);
  m.add("", 0.12);
  EXPECT_NEAR(of(accuracy_of(m.list, m.found, {""}), open_cover).q90, 0.109, 1e-12);
}

TEST(CheckPointAccuracy, FewerThanThreeStateNone) {
  Marks m;
  for (const double e : {0.01, 0.02}) m.add("forest", e);
  for (const double e : {0.01, 0.02, 0.03}) m.add("bare", e);
  const auto all = accuracy_of(m.list, m.found, {"bare"});
  EXPECT_EQ(judged_accuracy(all, "points", vegetated_cover), nullptr);
  EXPECT_EQ(judged_accuracy(all, "dtm", open_cover), nullptr);
  ASSERT_NE(judged_accuracy(all, "points", open_cover), nullptr);
  EXPECT_EQ(judged_accuracy(all, "points", open_cover)->errors.n, 3u);
}

TEST(CheckPointAccuracy, TheClosestIntervalHoldsForBothFigures) {
  Marks m;
  for (int k = 0; k < 18; ++k) m.add("", 0.05);
  for (int k = 0; k < 4; ++k) m.add("", 0.60);  // more than a tenth
  const auto all = accuracy_of(m.list, m.found, {""});
  MapOptions o;
  o.interval = core::Metres(1.0);
  o.flying_height = core::Metres(1200.0);
  const auto map = map_class_of(o, judged_accuracy(all, "points", every_cover), std::nullopt, 0.0);
  ASSERT_TRUE(map);
  EXPECT_NEAR(*map->q90_height, 0.60, 1e-12);
  EXPECT_NEAR(map->intervals[0].interval, 1.20, 1e-9);  // 90 % within half of it; the standard error of 0.26 m needs 0.78 m
  EXPECT_NEAR(*map->c_factor, 1000.0, 1e-6);
  EXPECT_EQ(*map->height_class, "B");
  o.interval = core::Metres(map->intervals[0].interval);
  EXPECT_EQ(*map_class_of(o, judged_accuracy(all, "points", every_cover), std::nullopt, 0.0)->height_class, "A");
  EXPECT_FALSE(map_class_of(MapOptions{}, nullptr, 0.2, 0.1));
}

TEST(CheckPointAccuracy, PlanimetryOfAMapIsStatedMeasuredOrPredicted) {
  MapOptions o;
  o.scale = 1000.0;
  EXPECT_EQ(map_class_of(o, nullptr, std::nullopt, 0.1)->plan_from.substr(0, 9), "predicted");
  const auto by_roofs = map_class_of(o, nullptr, 0.2, 0.1);
  EXPECT_NEAR(*by_roofs->ep_plan, 0.2, 1e-12);
  EXPECT_EQ(by_roofs->plan_from, "measured: radial RMSE of roofs");
  o.planimetry = core::Metres(0.3);
  EXPECT_NEAR(*map_class_of(o, nullptr, 0.2, 0.1)->ep_plan, 0.3, 1e-12);
}

TEST(CheckPointAccuracy, OptionsOfAMapThatWouldDoNothingAreRefused) {
  const auto fault = [](const std::string& map) { return fault_of([&] { stage_with("quality.points", "[map]\n" + map); }); };
  EXPECT_EQ(fault("scale = 1000\nplanimetry = \"20 cm\"\n"), "");
  EXPECT_EQ(fault("interval = \"1 m\"\nflying_height = \"900 m\"\nc_factor = 1200\n"), "");
  EXPECT_NE(fault("planimetry = \"20 cm\"\n").find("scale"), std::string::npos);
  EXPECT_NE(fault("interval = \"1 m\"\nplanimetry = \"20 cm\"\n").find("planimetry is judged by a scale"), std::string::npos);
  EXPECT_NE(fault("interval = \"1 m\"\nc_factor = 1200\n").find("flying_height"), std::string::npos);
}

TEST(CheckPointFiles, NamesAndCoversAreOneFieldEach) {
  Work w;
  Marks m;
  m.add("grass, short", 0.01);
  m.list[0].name = "A \"7\"";
  m.add("=1+1", 0.02);
  write_marks(w.context, "marks", m.list, m.found, {});
  const std::string table = test::read_bytes(w.folder / "products/marks.csv");
  EXPECT_NE(table.find("\"A \"\"7\"\"\",600000.000,5300000.000,400.000,0.0200,\"grass, short\",0.0100,,0.0300,0.0000,,metre,metre,metre\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("p2,600001.000,5300000.000,400.000,0.0200,'=1+1,"), std::string::npos) << table;
}

}  // namespace
}  // namespace swath::stages
