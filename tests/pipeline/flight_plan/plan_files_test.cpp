// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_files.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/text/value_file.h"
#include "io/vector/vector.h"
#include "simulate/simulate.h"
#include "tests/pipeline/flight_plan/flight_plan_support.h"
#include "tests/world/npy_columns.h"

namespace swath::pipeline {
namespace {

TEST(PlanFiles, EveryFileHoldsTheLines) {
  const test::TemporaryFolder folder;
  write_hills(folder / "hills.tif");
  const PlanRequest request = request_of(folder, plan_toml("name = \"a < b\"\ndem = \"hills.tif\""));
  const planning::FlightPlan plan = write_flight_plan(request);
  ASSERT_GE(plan.lines.size(), 3u);
  EXPECT_EQ(test::entries(request.folder), 9u);

  const io::VectorLines lines = io::read_lines(request.folder / "lines.gpkg");
  ASSERT_EQ(lines.lines.size(), plan.lines.size());
  EXPECT_EQ(core::Crs(lines.crs_wkt).epsg(), 32632);
  EXPECT_EQ(lines.lines[0].height, plan.lines[0].line.level);
  EXPECT_NEAR(lines.lines[0].x[0], plan.lines[0].line.from.x(), 1e-9);

  const io::VectorLines map = io::read_lines(request.folder / "lines.kml");
  ASSERT_EQ(map.lines.size(), plan.lines.size() + 1);  // and the area
  const core::Transform back(core::Crs("EPSG:4326"), core::Crs("EPSG:32632"));
  EXPECT_NEAR(back({map.lines[1].x[0], map.lines[1].y[0], 0}).x(), plan.lines[0].line.from.x(), 0.01);

  const std::string table = io::read_text_file(request.folder / "lines.csv");
  EXPECT_EQ(static_cast<size_t>(std::count(table.begin(), table.end(), '\n')), plan.lines.size() + 1);

  const core::Value json = io::read_value_file(request.folder / "plan.json");
  EXPECT_EQ(json.find("lines")->items().size(), plan.lines.size());
  EXPECT_EQ(json.find("name")->as_text(), "a < b");
  EXPECT_NE(io::read_text_file(request.folder / "plan.html").find("a &lt; b"), std::string::npos);
  EXPECT_NE(plan_text(plan).find("lines"), std::string::npos);
  const io::Raster density = io::read_raster(request.folder / "density.tif");
  EXPECT_EQ(static_cast<size_t>(density.nx), static_cast<size_t>(plan.coverage.lattice.nx));
}

TEST(PlanFiles, NoInputIsWrittenOver) {
  const test::TemporaryFolder folder;
  write_hills(folder / "density.tif");
  PlanRequest request = request_of(folder, plan_toml("dem = \"density.tif\""));
  request.folder = folder.path();
  const std::string before = test::read_bytes(folder / "density.tif");
  EXPECT_THROW(write_flight_plan(request), core::Error);
  EXPECT_EQ(test::read_bytes(folder / "density.tif"), before);
}

TEST(PlanFiles, ARefusedPlanLeavesNothing) {
  const test::TemporaryFolder folder;
  const PlanRequest request = request_of(folder, plan_toml("crs = \"EPSG:32632\"\nground = \"500 m\"", "density = 500"));
  EXPECT_THROW(write_flight_plan(request), core::Error);
  EXPECT_FALSE(std::filesystem::exists(request.folder));
}

/// The plan is flown: pulses and lines cell by cell, in still air.
TEST(PlanFiles, WhatIsFlownIsWhatWasPlanned) {
  const test::TemporaryFolder folder;
  write_hills(folder / "hills.tif");
  PlanRequest request = request_of(folder, plan_toml("dem = \"hills.tif\"\ncell = \"50 m\"",
                                                     "height = \"600 m\"\nterrain_following = true\nmargin = \"60 m\"\n"
                                                     "[simulate.noise]\nnoise_free = true\n"
                                                     "[simulate.flight]\nturbulence = 0.0\n"
                                                     "[simulate.imu]\nfile = false\n"
                                                     "[simulate.gnss]\nfile = false\n"));
  request.sets = {"sensor.prf=\"25 kHz\""};
  const planning::FlightPlan plan = write_flight_plan(request);
  const simulate::Options options = simulate::read_options(io::read_value_file(request.folder / "simulate.json"));
  EXPECT_EQ(options.scanner.prf.value, 25e3);
  const simulate::Made made = simulate::run(options, folder / "flown");
  EXPECT_EQ(made.lines, plan.lines.size());
  EXPECT_NEAR(made.seconds, plan.seconds, 0.45 * plan.seconds);  // the simulated aircraft rolls into its turns, and makes no bulbs

  const core::Lattice& l = plan.coverage.lattice;
  std::vector<double> flown(l.size(), 0.0);
  const auto truth = test::npy_columns(folder / "flown/truth/returns.npy");
  const std::vector<double>&east = truth.at("e"), &north = truth.at("n"), &height = truth.at("h");
  const PlanInput input = read_plan_input(request);
  for (size_t k = 0; k < east.size(); ++k) {
    EXPECT_NEAR(height[k], input.ground.height(east[k], north[k]), 1e-3);
    const std::int64_t i = core::cell_index(east[k], l.cell) - l.i0, j = core::cell_index(north[k], l.cell) - l.j0;
    if (i >= 0 && j >= 0 && i < l.nx && j < l.ny) flown[l.at(static_cast<int>(i), static_cast<int>(j))] += 1.0 / (l.cell * l.cell);
  }
  size_t compared = 0, near = 0;
  for (size_t k = 0; k < l.size(); ++k) {
    const auto seen = static_cast<double>(plan.coverage.lines[k]);
    if (!std::isfinite(seen) || std::abs(seen - std::round(seen)) > 1e-3) continue;
    ++compared;
    if (std::abs(flown[k] / static_cast<double>(plan.coverage.density[k]) - 1.0) < 0.1) ++near;
  }
  EXPECT_GT(compared, 300u);
  EXPECT_GE(static_cast<double>(near), 0.98 * static_cast<double>(compared));
}

}  // namespace
}  // namespace swath::pipeline
