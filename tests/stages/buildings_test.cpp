// SPDX-License-Identifier: GPL-3.0-or-later
// terrain.buildings by tiles: its files, units, clouds without buildings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "io/vector/vector.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Block;
using core::Value;

constexpr double town_x = 500000.0, town_y = 5300000.0, town_side = 120.0;  // m
constexpr double foot = 1200.0 / 3937.0;                                    // m, US survey foot

double slope_height(double x) { return 0.05 * (x - town_x); }

/// The ground is a slope of 5 %.
class SlopeGrids : public Grids {
 public:
  bool any = true;
  bool has(Product) const override { return true; }
  core::Grid window(Product, const core::Lattice& l) const override {
    core::Grid g(l);
    if (!any) return g;
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i)
        g.height[l.at(i, j)] = static_cast<float>(slope_height(l.centre_x(i))), g.reason[l.at(i, j)] = core::Void::none;
    return g;
  }
  fs::path folder(Product) const override { return {}; }
  double cell(Product) const override { return 0.5; }
};

/// A gable house, a hall, and one return alone that is of class building.
Block town(bool with_buildings) {
  Block b;
  b.origin = {town_x, town_y, 0};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(0.0, town_side);
  std::normal_distribution<double> noise(0.0, 0.02);
  const auto add = [&](double x, double y, double z, std::uint8_t c) {
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(z), b.classification.push_back(c), b.flags.push_back(0);
  };
  for (int k = 0; k < static_cast<int>(town_side * town_side * 6); ++k) {
    const double x = place(random), y = place(random), ground = slope_height(town_x + x) + noise(random);
    const bool hall = x > 40 && x < 75 && y > 50 && y<75, house = x> 90 && x < 104 && y > 20 && y < 30;
    if (with_buildings && (hall || house))
      add(x, y, (hall ? 12.0 : 14.0 - 0.6 * std::abs(y - 25)) + noise(random), 6);
    else
      add(x, y, ground, 2);
  }
  if (with_buildings) add(20, 20, 8.0, 6);
  return b;
}

struct TownRun {
  test::TemporaryFolder folder;
  io::Survey survey;
  SlopeGrids grids;
  Context context{survey};
  Value findings;

  /// `unit`: of the CRS, m.
  TownRun(const Block& all, double tile, const std::string& options = {}, const std::string& crs = "EPSG:32632", double unit = 1.0,
          bool with_ground = true) {
    grids.any = with_ground;
    context.grids = &grids;
    context.output = folder / "out";
    context.product_crs = crs;
    context.origin = all.origin;
    context.tile_side = tile;
    context.unit = context.vertical_unit = unit;
    fs::create_directories(context.output);
    fs::create_directories(folder / "work");
    const auto stage = make_stage("terrain.buildings");
    std::vector<core::Fault> faults;
    core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_toml(options, "test"), "", faults);
    core::throw_if_any(faults);
    MergeJob merge{folder / "work", {}, {}};
    const int from_x = static_cast<int>(std::floor(town_x / tile)), from_y = static_cast<int>(std::floor(town_y / tile));
    for (int ix = from_x; context.box_of({ix, 0}).x0 < town_x + town_side; ++ix)
      for (int iy = from_y; context.box_of({0, iy}).y0 < town_y + town_side; ++iy) {
        TileJob job{{ix, iy}, context.box_of({ix, iy}), folder / "work", {}, 0, {}};
        std::vector<std::uint32_t> own;
        for (std::uint32_t p = 0; p < all.size(); ++p)
          if (job.box.holds(all.origin.x() + all.x[p], all.origin.y() + all.y[p])) own.push_back(p);
        std::reverse(own.begin(), own.end());
        job.own = own.size();
        job.block = core::select(all, own);
        stage->run_tile(context, job);
        merge.tiles.push_back(job.key);
      }
    stage->run_merge(context, merge);
    findings = merge.findings;
  }
  double number(const char* key) const { return findings.find(key)->as_number(); }
  std::string bytes(const char* file) const { return test::read_bytes(context.output / file); }
};

TEST(BuildingsStage, ABuildingThatTileEdgesCutIsOneAndTheTilingChangesNothing) {
  const Block all = town(true);
  const TownRun whole(all, 1000.0), tiled(all, 30.0);
  EXPECT_EQ(whole.number("buildings"), 2.0);
  EXPECT_EQ(whole.number("planes"), 3.0);
  EXPECT_EQ(whole.number("squared"), 2.0);
  EXPECT_EQ(whole.number("with_roof"), 2.0);
  EXPECT_EQ(whole.number("cut"), 0.0);
  EXPECT_EQ(whole.number("single_returns"), 1.0);
  EXPECT_NEAR(whole.number("area_m2"), 35 * 25 + 14 * 10, 15.0);
  EXPECT_EQ(io::to_json(whole.findings), io::to_json(tiled.findings));
  for (const char* file : {"buildings.gpkg", "buildings.csv", "buildings.city.json"})
    EXPECT_TRUE(whole.bytes(file) == tiled.bytes(file)) << file;
  const std::string table = whole.bytes("buildings.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
}

TEST(BuildingsStage, HeightsCountFromTheGroundThatWasChosen) {
  const Block all = town(true);
  // The upper of two: above the lowest ground that is the hall, above the mean the house.
  EXPECT_NEAR(TownRun(all, 1000.0).number("median_ridge_m"), 12 - 0.05 * 39, 0.05);
  EXPECT_NEAR(TownRun(all, 1000.0, "ground = \"mean\"").number("median_ridge_m"), 14 - 0.05 * 97, 0.05);
}

TEST(BuildingsStage, FeetStayFeetOnTheMapAndAttributesAreInMetres) {
  const Block all = town(true);
  const TownRun metres(all, 1000.0), feet(all, 1000.0, "", "EPSG:2229+6360", foot);
  EXPECT_EQ(feet.number("area_m2"), metres.number("area_m2"));
  EXPECT_EQ(feet.number("median_ridge_m"), metres.number("median_ridge_m"));
  const io::VectorLines outlines = io::read_lines(feet.context.output / "buildings.gpkg");
  for (const double x : outlines.lines.at(0).x) EXPECT_NEAR(x * foot, town_x + 57.5, 18.5);
  const Value city = io::read_value_file(feet.context.output / "buildings.city.json");
  EXPECT_NEAR(city.find("metadata")->find("geographicalExtent")->items()[5].as_number() * foot, 14.0, 0.1);
  EXPECT_EQ(city.find("metadata")->find("referenceSystem")->as_text(), "https://www.opengis.net/def/crs/EPSG/0/2229");
}

TEST(BuildingsStage, ACloudWithoutBuildingsOrPointsGivesEmptyFiles) {
  for (const Block& all : {town(false), [] {
                             Block none;
                             none.origin = {town_x, town_y, 0};
                             return none;
                           }()}) {
    const TownRun run(all, 1000.0);
    EXPECT_EQ(run.number("buildings"), 0.0);
    EXPECT_EQ(run.number("returns"), 0.0);  // pipeline/report_warnings.cpp warns by it
    EXPECT_TRUE(io::read_value_file(run.context.output / "buildings.city.json").find("vertices")->items().empty());
    EXPECT_TRUE(fs::exists(run.context.output / "buildings.gpkg"));
  }
}

TEST(BuildingsStage, WithoutTerrainThereAreOutlinesAndNoHeights) {
  const Block all = town(true);
  const TownRun run(all, 1000.0, "", "EPSG:32632", 1.0, false);
  EXPECT_EQ(run.number("buildings"), 2.0);
  EXPECT_EQ(run.number("without_ground"), 2.0);
  EXPECT_EQ(run.number("without_block"), 2.0);
  EXPECT_EQ(run.findings.find("median_ridge_m"), nullptr);
}

TEST(BuildingsStage, AnAreaWithoutUnitIsRefused) { EXPECT_THROW(TownRun(town(false), 1000.0, "min_area = \"10\""), core::Error); }

}  // namespace
}  // namespace swath::stages
