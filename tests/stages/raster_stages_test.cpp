// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that make grids, tile by tile: the tiling has no say, and what earlier stages left is checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <random>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/paste.h"
#include "io/las/las_writer.h"
#include "io/text/value_file.h"
#include "stages/grid_tile.h"
#include "stages/registry.h"
#include "terrain/water/breaklines.h"
#include "tests/stages/tile_work.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

core::Block points(double side) {
  core::Block b;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, side);
  core::resize(b, static_cast<size_t>(4 * side * side));
  core::add_columns(b, {core::Column::intensity, core::Column::return_number, core::Column::return_count, core::Column::classification,
                        core::Column::flags});
  for (size_t p = 0; p < b.size(); ++p) {
    b.x[p] = place(random), b.y[p] = place(random);
    b.intensity[p] = static_cast<std::uint16_t>(1000 + 10 * b.x[p]);
    b.return_number[p] = b.return_count[p] = 1;
    b.classification[p] = core::point_class::ground;
  }
  return b;
}

/// Cells that the tile's border cuts hold the points of both sides.
void expect_the_tiling_changes_nothing(const std::string& type, const std::vector<std::string>& grids) {
  Work w;
  const core::Block all = points(100.0);
  const auto stage = stage_with(type, "cell = \"3 m\"");
  w.context.tile_side = 100.0;
  w.run(*stage, all, 0, 0, w.folder / "whole");
  w.context.tile_side = 25.0;
  for (int iy = 0; iy < 4; ++iy)
    for (int ix = 0; ix < 4; ++ix) w.run(*stage, all, ix, iy, w.folder / "parts");
  for (const std::string& grid : grids) {
    const core::Grid whole = io::read_grid_file(grid_file(w.folder / ("whole/" + grid), {0, 0}));
    core::Grid parts(whole.lattice);
    for (int iy = 0; iy < 4; ++iy)
      for (int ix = 0; ix < 4; ++ix) core::paste(io::read_grid_file(grid_file(w.folder / ("parts/" + grid), {ix, iy})), parts);
    EXPECT_EQ(parts.height, whole.height) << grid;
    EXPECT_EQ(parts.reason, whole.reason) << grid;
  }
}

TEST(RasterStages, DensityDoesNotDependOnTheTiling) {
  expect_the_tiling_changes_nothing("terrain.density", {"pulse_density", "return_density"});
}

TEST(RasterStages, IntensityDoesNotDependOnTheTiling) { expect_the_tiling_changes_nothing("terrain.intensity", {""}); }

TEST(RasterStages, CellsOutsideTheBoundaryAreNoHolesOfTheVisibility) {
  Work w;
  core::Block all = points(60.0);
  for (size_t p = 0; p < all.size(); ++p)
    if (all.x[p] > 20.0 && all.y[p] > 20.0 && all.y[p] < 40.0) all.classification[p] = core::point_class::high_vegetation;
  const core::Breakline edge{core::BreaklineKind::boundary, "edge", {{{0, 0, 0}, {45, 0, 0}, {45, 60, 0}, {0, 60, 0}}}, false, 0.0};
  w.context.tile_side = 60.0;
  w.grids.folders[Product::breaklines] = w.folder / "breaklines";
  fs::create_directories(w.folder / "breaklines");
  test::write_bytes(w.folder / "breaklines/breaklines.settled", terrain::pack({{edge, false}}));
  terrain::BreaklineOptions options;
  test::write_bytes(w.folder / "breaklines/options.json", io::to_json(core::effective_values(core::described(options))));
  w.grids.made[Product::visibility] = [](double, double, float&, core::Void& reason) { reason = core::Void::never_seen; };
  w.run(*stage_with("terrain.dtm", "max_edge = \"6 m\""), all, 0, 0, w.folder / "dtm");
  const core::Grid g = io::read_grid_file(grid_file(w.folder / "dtm", {0, 0}));
  EXPECT_EQ(g.reason[g.lattice.at(10, 30)], core::Void::none);
  EXPECT_EQ(g.reason[g.lattice.at(35, 30)], core::Void::never_seen);
  EXPECT_EQ(g.reason[g.lattice.at(50, 30)], core::Void::no_data);  // beyond the boundary
  EXPECT_EQ(g.reason[g.lattice.at(50, 10)], core::Void::no_data);
}

TEST(RasterStages, ATerrainModelOfNoUsablePointSaysWhy) {
  const auto fault = [](const std::function<void(core::Block&)>& change) {
    Work w;
    w.context.tile_side = 10.0;
    core::Block all = points(20.0);
    change(all);
    return fault_of([&] { w.run_all(*stage_with("terrain.dtm", ""), all, w.folder / "dtm"); });
  };
  const auto all_of = [](auto& column, int value) { std::fill(column.begin(), column.end(), static_cast<std::uint8_t>(value)); };
  EXPECT_EQ(fault([](core::Block&) {}), "");
  std::string said = fault([&](core::Block& b) { all_of(b.flags, core::flag::withheld); });
  EXPECT_NE(said.find("all 1600 points are withheld: "), std::string::npos) << said;
  said = fault([&](core::Block& b) { all_of(b.classification, core::point_class::low_noise); });
  EXPECT_NE(said.find("all 1600 points are noise (class 7 or 18)"), std::string::npos) << said;
  said = fault([&](core::Block& b) {
    all_of(b.classification, core::point_class::high_noise);
    b.flags[3] = core::flag::withheld;
  });
  EXPECT_NE(said.find("all 1600 points are withheld (1) or noise (1599)"), std::string::npos) << said;
  said = fault([&](core::Block& b) { all_of(b.classification, core::point_class::unassigned); });
  EXPECT_NE(said.find("no triangle of ground points (class 2): all 1600 points are of other classes"), std::string::npos) << said;
}

TEST(RasterStages, ContoursTellOfDamagedIntermediateFiles) {
  Work w;
  w.context.tile_side = 60.0;
  w.grids.made[Product::dtm] = [](double x, double y, float& height, core::Void& reason) {
    height = static_cast<float>(0.3 * x + 0.1 * y);
    reason = core::Void::none;
  };
  const auto stage = stage_with("terrain.contours", "interval = \"1 m\"");
  const fs::path folder = w.folder / "contours", file = folder / "0_0.segments";
  w.run(*stage, {}, 0, 0, folder);
  const auto merge = [&] {
    MergeJob job{folder, {{0, 0}}, {}};
    stage->run_merge(w.context, job);
  };
  EXPECT_EQ(fault_of(merge), "");
  const std::string bytes = test::read_bytes(file);
  ASSERT_GT(bytes.size(), 1000u);
  test::write_bytes(file, bytes.substr(0, bytes.size() - 7));
  EXPECT_NE(fault_of(merge).find("0_0.segments"), std::string::npos);
  fs::remove(file);
  EXPECT_NE(fault_of(merge).find("0_0.segments"), std::string::npos);
}

TEST(RasterStages, ContoursByTheMillimetreAreRefused) {
  Work w;
  w.context.tile_side = 2.0;
  w.grids.made[Product::dtm] = [](double x, double, float& height, core::Void& reason) {
    height = static_cast<float>(18.0 * x);
    reason = core::Void::none;
  };
  const fs::path folder = w.folder / "contours";
  const std::string said =
      fault_of([&] { w.run(*stage_with("terrain.contours", "interval = \"0.5 mm\"\ntolerance = \"0 m\""), {}, 0, 0, folder); });
  EXPECT_NE(said.find("contours.interval: contours every 0.0005 m between heights of "), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(folder / "0_0.segments"));
  // One tile alone is drawn at 1 mm, two are too much.
  const auto stage = stage_with("terrain.contours", "interval = \"1 mm\"\ntolerance = \"0 m\"");
  EXPECT_EQ(fault_of([&] {
              w.run(*stage, {}, 0, 0, folder);
              w.run(*stage, {}, 1, 0, folder);
            }),
            "");
  EXPECT_NE(fault_of([&] {
              MergeJob job{folder, {{0, 0}, {1, 0}}, {}};
              stage->run_merge(w.context, job);
            }).find("levels"),
            std::string::npos);
}

TEST(RasterStages, BreaklinesTellOfDamagedIntermediateFiles) {
  Work w;
  test::write_bytes(w.folder / "lake.geojson",
                    R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[{"type":"Feature",
"properties":{},"geometry":{"type":"Polygon","coordinates":[[[600010,5300010],[600030,5300010],[600030,5300030],[600010,5300030],
[600010,5300010]]]}}]})");
  w.survey.crs = "EPSG:32632";
  io::BreaklineFile f;
  f.file = w.folder / "lake.geojson";
  f.kind = core::BreaklineKind::lake;
  w.survey.breaklines.push_back(f);
  w.context.origin = {600000.0, 5300000.0, 0.0};
  w.context.tile_side = 100.0;
  core::Block all = points(60.0);
  all.origin = w.context.origin;
  const auto stage = make_stage("terrain.breaklines");
  const fs::path folder = w.folder / "breaklines", file = folder / "6000_53000.shores";
  w.run(*stage, all, 6000, 53000, folder);
  const auto merge = [&] {
    MergeJob job{folder, {{6000, 53000}}, {}};
    stage->run_merge(w.context, job);
  };
  EXPECT_EQ(fault_of(merge), "");
  const std::string bytes = test::read_bytes(file);
  ASSERT_GT(bytes.size(), 100u);
  test::write_bytes(file, bytes.substr(0, bytes.size() - 7));
  EXPECT_NE(fault_of(merge).find("6000_53000.shores"), std::string::npos);
}

TEST(RasterStages, ARangeGateOnACloudWithoutRangesIsRefusedBeforeTheRun) {
  Work w;
  const auto write = [&](const std::string& name, bool ranges) {
    core::Block b = points(3.0);
    if (ranges) core::add_columns(b, {core::Column::range});
    io::LasWriter writer(w.folder / name, {});
    writer.write(b);
    writer.finish();
  };
  write("with.las", true);
  write("without.las", false);
  const auto source = make_stage("readers.las"), gate = stage_with("filters.noise", "range_max = \"900 m\""),
             noise = make_stage("filters.noise");
  w.context.source = source.get();
  io::PointFile f;
  f.file = w.folder / "with.las";
  w.survey.points = {f};
  EXPECT_EQ(fault_of([&] { gate->check(w.context); }), "");
  f.file = w.folder / "without.las";
  w.survey.points.push_back(f);
  const std::string text = fault_of([&] { gate->check(w.context); });
  for (const char* part : {"filters.noise", "without.las", "range"}) EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(fault_of([&] { noise->check(w.context); }), "");
}

}  // namespace
}  // namespace swath::stages
