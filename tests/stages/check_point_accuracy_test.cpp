// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy by check points: formulas by hand, classes of a map, and the table that is left of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stages/adapters/quality/mark_accuracy.h"
#include "stages/adapters/quality/mark_files.h"
#include "stages/adapters/quality/quality_facts.h"
#include "stages/adapters/quality/seen_cells.h"
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

/// Two lines over a slope of 10 %, one of them 6 cm higher; check points every 11 m, most within reach of several parts.
struct CheckedTile {
  static constexpr double side = 100.0, east = 600000.0, north = 5300000.0, spacing = 0.7;
  Work w;
  std::unique_ptr<Stage> stage = stage_with("quality.points", "radius = \"3 m\"");
  core::Block all;
  CheckedTile() {
    std::string table = "name,x,y,z\n";
    for (double x = 5.0; x < side; x += 11.0)
      for (double y = 6.0; y < side; y += 11.0) {
        char row[90];
        std::snprintf(row, sizeof row, "m%.0f_%.0f,%.3f,%.3f,%.3f\n", x, y, east + x, north + y, 400.0 + 0.1 * x + 0.01 * std::sin(y));
        table += row;
      }
    test::write_bytes(w.folder / "marks.csv", table);
    w.survey.folder = w.folder.path();
    w.survey.crs = "EPSG:32632";
    io::ControlFile marks;
    marks.file = "marks.csv";
    marks.use = io::ControlUse::check;
    w.survey.control.push_back(marks);
    w.context.crs = core::Crs("EPSG:32632");
    w.context.tile_side = side;
    all.origin = {east, north, 400.0};
    for (double x = 0.2; x < side; x += spacing)
      for (double y = 0.1; y < side; y += spacing) {
        const bool second = std::fmod(x + y, 3.0) < 1.2;
        all.x.push_back(x), all.y.push_back(y), all.z.push_back(0.1 * x + (second ? 0.06 : 0.0));
        all.strip.push_back(second ? 2 : 1);
      }
    core::add_columns(all, {core::Column::classification, core::Column::flags});
    std::fill(all.classification.begin(), all.classification.end(), std::uint8_t{2});
  }
  std::string merged(const fs::path& folder) {
    MergeJob job{folder, {{6000, 53000}}, {}};
    stage->run_merge(w.context, job);
    return test::read_bytes(w.context.output / "check_points.csv");
  }
};

TEST(CheckPointFiles, ATileInPartsGivesWhatTheWholeTileDoes) {
  CheckedTile t;
  const Box tile{CheckedTile::east, CheckedTile::north, CheckedTile::east + CheckedTile::side, CheckedTile::north + CheckedTile::side};
  t.w.run_in(*t.stage, t.all, {6000, 53000}, tile, t.w.folder / "whole");
  const std::string whole = t.merged(t.w.folder / "whole");
  EXPECT_GT(std::count(whole.begin(), whole.end(), '\n'), 80);
  EXPECT_NE(whole.find(" 2:"), std::string::npos) << "no check point is compared with two lines";
  std::vector<fs::path> parts;
  for (int k = 0; k < 4; ++k) {
    const double x = tile.x0 + 50.0 * (k % 2), y = tile.y0 + 50.0 * (k / 2);
    parts.push_back(t.w.folder / ("part_" + std::to_string(k)));
    t.w.run_in(*t.stage, t.all, {6000, 53000}, {x, y, x + 50.0, y + 50.0}, parts.back());
  }
  ASSERT_TRUE(t.stage->is_divisible());
  t.stage->join_parts(t.w.context, {{6000, 53000}, tile, t.w.folder / "joined", {}, 0, {}}, parts);
  EXPECT_EQ(t.merged(t.w.folder / "joined"), whole);
}

TEST(SeenCells, HoldTheTilesOwnPointsAndTheDistanceIsFromTheirEdges) {
  core::Block b;
  b.origin = {1000.0, 2000.0, 0.0};
  b.x = {1.0, 3.0, 80.0, 500.0}, b.y = {1.0, 24.0, -1.0, 500.0}, b.z = {0.0, 0.0, 0.0, 0.0};
  core::add_columns(b, {core::Column::classification, core::Column::flags});
  const std::vector<SeenCell> seen = seen_cells(b, 3);  // the fourth is of the halo
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0], (SeenCell{40, 80}));
  EXPECT_EQ(seen[1], (SeenCell{43, 79}));
  EXPECT_EQ(away(seen, {1010.0, 2020.0, 7.0}), 0.0);
  EXPECT_NEAR(away(seen, {1000.0 - 3.0, 2025.0 + 4.0, 7.0}), 5.0, 1e-9);
  EXPECT_TRUE(std::isinf(away({}, {0.0, 0.0, 0.0})));
  b.classification = {7, 7, 7, 7};
  EXPECT_TRUE(seen_cells(b, 3).empty());
}

TEST(CheckPointFiles, NamesAndCoversAreOneFieldEach) {
  Work w;
  Marks m;
  m.add("grass, short", 0.01);
  m.list[0].name = "A \"7\"";
  m.add("=1+1", 0.02);
  write_marks(w.context, "marks", m.list, m.found, {});
  const std::string table = test::read_bytes(w.folder / "products/marks.csv");
  EXPECT_NE(table.find("\"A \"\"7\"\"\",600000.000,5300000.000,400.000,0.0200,\"grass, short\",0.0100,,0.0300,0.0000,,m,m,m\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("p2,600001.000,5300000.000,400.000,0.0200,'=1+1,"), std::string::npos) << table;
}

TEST(CheckPointFiles, UnitsAreNamedByTheirSymbols) {
  Work w;
  w.context.crs = core::Crs("EPSG:2225+6360");  // feet; NAVD88 in US survey feet
  w.context.product_crs = "EPSG:2225+6360";
  w.context.unit = w.context.vertical_unit = 1200.0 / 3937.0;
  EXPECT_EQ(quality_facts(w.context, {}).unit, "ftUS");
  Marks m;
  m.add("grass", 0.01);
  write_marks(w.context, "marks", m.list, m.found, {});
  const std::string table = test::read_bytes(w.folder / "products/marks.csv");
  EXPECT_NE(table.find(",ftUS,ftUS,m\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace swath::stages
