// SPDX-License-Identifier: GPL-3.0-or-later
// Stages along a corridor, tile by tile: power lines with what is around them, and a part of a cloud.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "io/raster/png.h"
#include "tests/stages/tile_work.h"
#include "tests/world/power_line.h"

namespace swath::stages {
namespace {

constexpr const char* limits = "ground = \"6 m\"\nvegetation = \"12 m\"\nbuilding = \"5 m\"\nwire = \"1 m\"\n";

/// A line of two spans with trees, one of them beside the support in its middle, high enough to fall on the wires of both.
struct Corridor {
  test::PowerLineScene scene;
  Work work;
  Corridor() {
    test::LineOfWires o;
    o.turns = {0.0, 0.0};
    o.span = 120.0;
    scene = test::make_power_line(o);
    core::Block& b = scene.block;
    b.classification = scene.truth;
    b.flags.assign(b.size(), 0);
    const Eigen::Vector2d along = (scene.pylons[2] - scene.pylons[0]).normalized(), across(-along.y(), along.x());
    tree(scene.pylons[1] + 14.0 * across, 26.0);
    work.context.origin = b.origin;
  }
  void tree(const Eigen::Vector2d& at, double height) {
    core::Block& b = scene.block;
    for (int k = 0; k < 40; ++k) {
      b.x.push_back(at.x() + 0.2 * (k % 5)), b.y.push_back(at.y() + 0.2 * (k % 7));
      b.z.push_back(scene.terrain(at.x(), at.y()) + height - 0.1 * k);
      b.strip.push_back(1), b.return_number.push_back(1), b.return_count.push_back(1), b.flags.push_back(0);
      b.height.push_back(static_cast<float>(height - 0.1 * k));
      b.classification.push_back(core::point_class::high_vegetation);
    }
  }
  MergeJob run(const std::string& options, double tile, const std::string& name) {
    work.context.tile_side = tile;
    work.context.output = work.folder / (name + "/products");
    return work.run_all(*stage_with("terrain.powerlines", limits + options), scene.block, work.folder / name);
  }
};

std::vector<std::vector<std::string>> rows_of(const fs::path& file) {
  std::vector<std::vector<std::string>> out;
  std::istringstream in(test::read_bytes(file));
  for (std::string row; std::getline(in, row);) {
    out.emplace_back();
    std::istringstream fields(row);
    for (std::string cell; std::getline(fields, cell, ',');) out.back().push_back(cell);
  }
  return out;
}

TEST(PowerLineStage, TheTilingChangesNothing) {
  Corridor c;
  const MergeJob whole = c.run("", 1000.0, "whole"), parts = c.run("", 37.0, "parts");
  EXPECT_GT(parts.tiles.size(), 20u);
  EXPECT_EQ(io::to_json(parts.findings), io::to_json(whole.findings));
  for (const char* counted : {"returns of wires", "returns of towers", "returns around wires"})
    EXPECT_EQ(parts.tally.of(counted), whole.tally.of(counted)) << counted;
  EXPECT_EQ(whole.findings.find("conductors")->as_int(), 6);
  EXPECT_EQ(whole.findings.find("whole_spans")->as_int(), 2);
  EXPECT_EQ(whole.findings.find("pylons")->as_int(), 3);
  for (const char* layer : {"conductors", "spans", "pylons", "clearances", "infringements", "falling_trees"}) {
    const std::string file = std::string("products/powerlines_") + layer + ".csv";
    EXPECT_EQ(test::read_bytes(c.work.folder / ("parts/" + file)), test::read_bytes(c.work.folder / ("whole/" + file))) << layer;
  }
}

TEST(PowerLineStage, ATreeBesideASupportIsOneAndASquareMetreCountsOnce) {
  Corridor c;
  const MergeJob job = c.run("name = \"line\"\nsheets = \"none\"\n", 200.0, "out");
  const fs::path products = c.work.folder / "out/products";
  std::set<std::string> tops;
  const auto trees = rows_of(products / "line_falling_trees.csv");
  ASSERT_GT(trees.size(), 2u);
  for (size_t k = 1; k < trees.size(); ++k) tops.insert(trees[k][0] + " " + trees[k][1] + " " + trees[k][2]);
  EXPECT_EQ(tops.size(), trees.size() - 1);
  EXPECT_EQ(job.findings.find("falling_trees")->as_int(), static_cast<std::int64_t>(tops.size()));
  // Of each conductor the worst return of a square metre is listed; wires side by side have the same trees below them.
  std::set<std::string> cells;
  const auto infringements = rows_of(products / "line_infringements.csv");
  for (size_t k = 1; k < infringements.size(); ++k) {
    const auto cell = [&](size_t column, double origin) {
      return std::to_string(static_cast<long>(std::floor(std::stod(infringements[k][column]) - origin)));
    };
    cells.insert(infringements[k][4] + cell(0, c.scene.block.origin.x()) + " " + cell(1, c.scene.block.origin.y()));
  }
  EXPECT_LT(1.2 * static_cast<double>(cells.size()), static_cast<double>(infringements.size() - 1));
  // The table's millimetres may round a return into the next cell.
  EXPECT_NEAR(static_cast<double>(job.findings.find("infringements")->as_int()), static_cast<double>(cells.size()), 3.0);
  EXPECT_FALSE(fs::exists(products / "line_sheets"));
}

/// A delivered cloud may have the road below a wire in a class of its own.
TEST(PowerLineStage, RoadsAndRailsAreGround) {
  Corridor c;
  const MergeJob plain = c.run("sheets = \"none\"\n", 200.0, "plain");
  std::vector<std::uint8_t>& classes = c.scene.block.classification;
  for (size_t p = 0; p < classes.size(); ++p)
    if (classes[p] == core::point_class::ground) classes[p] = p % 2 ? 11 : 10;
  EXPECT_EQ(io::to_json(c.run("sheets = \"none\"\n", 200.0, "roads").findings), io::to_json(plain.findings));
}

TEST(PowerLineStage, EverySpanHasItsSheet) {
  Corridor c;
  c.run("sheets = \"png\"\n", 500.0, "out");
  const fs::path sheets = c.work.folder / "out/products/powerlines_sheets";
  for (const char* name : {"span_0001.png", "span_0002.png"}) EXPECT_EQ(io::read_png(sheets / name).width, 1400) << name;
  const std::string list = test::read_bytes(sheets / "tiles.json");
  EXPECT_NE(list.find("span_0002.png"), std::string::npos);
  for (const char* file : {"powerlines.gpkg", "powerlines.dxf"}) EXPECT_TRUE(fs::exists(sheets.parent_path() / file)) << file;
}

/// 4 points per m2 over 60 m by 60 m.
core::Block field() {
  core::Block b;
  b.origin = {600000.0, 5300000.0, 0.0};
  for (int j = 0; j < 120; ++j)
    for (int i = 0; i < 120; ++i) b.x.push_back(0.25 + 0.5 * i), b.y.push_back(0.25 + 0.5 * j), b.z.push_back(0.0);
  b.flags.assign(b.size(), 0);
  return b;
}

TEST(CropStage, KeepsThePartThatItsFilesName) {
  Work w;
  w.survey.folder = w.folder.path();
  test::write_bytes(w.folder / "axis.csv", "not a vector file");
  test::write_bytes(w.folder / "axis.geojson",
                    R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[{"type":"Feature",
"properties":{},"geometry":{"type":"LineString","coordinates":[[600000,5300030],[600060,5300030]]}}]})");
  w.context.crs = core::Crs("EPSG:32632");
  const core::Block all = field();
  w.context.origin = all.origin;
  const auto run = [&](const std::string& more, double tile, const std::string& name) {
    w.context.tile_side = tile;
    return w.run_all(*stage_with("filters.crop", "axis = \"axis.geojson\"\nbuffer = \"9.9 m\"\n" + more), all, w.folder / name);
  };
  const MergeJob whole = run("", 1000.0, "whole"), parts = run("", 25.0, "parts"), rest = run("keep = \"outside\"\n", 1000.0, "rest");
  EXPECT_EQ(whole.tally.of("points kept"), 120u * 40u);
  EXPECT_EQ(parts.tally.of("points kept"), whole.tally.of("points kept"));
  EXPECT_EQ(rest.tally.of("points withheld"), whole.tally.of("points kept"));
  EXPECT_NEAR(parts.findings.find("kept_share")->as_number(), 1.0 / 3.0, 1e-3);
  EXPECT_EQ(parts.findings.find("shapes")->as_int(), 1);

  const auto stage = stage_with("filters.crop", "axis = \"axis.geojson\"\nbuffer = \"9.9 m\"\n");
  EXPECT_EQ(stage->inputs(w.survey), std::vector<fs::path>{w.folder / "axis.geojson"});
  EXPECT_EQ(fault_of([&] { stage->check(w.context); }), "");
  EXPECT_NE(fault_of([&] { stage_with("filters.crop", "polygons = \"axis.geojson\"\n")->check(w.context); }).find("no area"),
            std::string::npos);
  core::Block elsewhere = field();
  elsewhere.origin.x() += 1000.0;
  w.context.origin = elsewhere.origin;
  w.context.tile_side = 1000.0;
  EXPECT_NE(fault_of([&] { w.run_all(*stage, elsewhere, w.folder / "none"); }).find("no point is left"), std::string::npos);
}

}  // namespace
}  // namespace swath::stages
