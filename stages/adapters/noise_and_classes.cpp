// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classify.h"
#include "filters/outlier.h"
#include "filters/water.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/kept_classes.h"

namespace swath::stages {
namespace {

using core::Column;

class Outlier : public OptionStage<Keeping<filters::OutlierOptions>> {
 public:
  const Info& info() const override {
    static const Info info{
        "filters.outlier",
        "Statistical outliers and small groups alone in space (birds, scraps of cloud, multipath): flagged and classed as "
        "noise, never deleted.",
        {Grain::tile},
        {Column::flags, Column::classification},
        {Column::flags, Column::classification},
        {Product::points},
        {}};
    return info;
  }
  double halo() const override { return filters::halo(options); }
  // Two bins of the points (56), their mean distances and cells (12), the cubes' index (40).
  double bytes_per_point() const override { return 112.0; }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, reach 0.8 m, window 1 m: 50 bytes per cell of a third of the window.
  std::vector<Raster> rasters(const Context& c) const override {
    const double side = c.tile_side + 2.0 * halo();
    return {{"window", filters::outlier_cell(options), side, 52.0}, {"reach", options.reach.value, side, 10.0}};
  }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::OutlierCounts n = filters::flag_outliers(job.block, job.own, options);
    kept.put_back(job.block, job.own, false, job.tally);
    job.tally.count("low noise", n.low_noise);
    job.tally.count("high noise", n.high_noise);
    if (n.statistical) job.tally.count("statistical outliers", n.statistical);
    if (n.grouped) job.tally.count("in groups alone in space", n.grouped);
    if (n.untouched) job.tally.count("withheld or noise already, not looked at", n.untouched);
  }
};

class Classify : public OptionStage<Keeping<filters::ClassifyOptions>> {
 public:
  const Info& info() const override {
    static const Info info{"filters.classify",
                           "Classes of what is not ground: low, medium and high vegetation, buildings, wires, bridge decks.",
                           {Grain::tile},
                           {Column::flags, Column::classification, Column::height},
                           {Column::flags, Column::classification},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::return_number, Column::return_count}; }
  double halo() const override { return filters::halo(options); }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m: up to 177 bytes per point where none is ground. Counted
  // 2026-11-23: samples of four returns with their hashes, planes and rasters per cell of 1 m.
  double bytes_per_point() const override { return 180.0; }
  std::vector<Raster> rasters(const Context& c) const override { return {{"", 1.0, c.tile_side + 2.0 * halo(), 165.0}}; }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::ClassifyCounts n = filters::classify(job.block, job.own, options);
    kept.put_back(job.block, job.own, false, job.tally);
    const auto report = [&](const char* name, std::uint64_t count) {
      if (count) job.tally.count(name, count);
    };
    report("low vegetation", n.low_vegetation);
    report("medium vegetation", n.medium_vegetation);
    report("high vegetation", n.high_vegetation);
    report("building", n.building);
    report("wire", n.wire);
    report("bridge deck", n.bridge_deck);
    report("low noise", n.low_noise);
    report("unassigned", n.unassigned);
    report("ground, water or noise, not looked at", n.kept);
  }
};

class Water : public OptionStage<Keeping<filters::WaterOptions>> {
 public:
  const Info& info() const override {
    static const Info info{"filters.water",
                           "Water (class 9) by level returns where most pulses do not come back; between a ground filter and the terrain.",
                           {Grain::tile},
                           {Column::flags, Column::classification},
                           {Column::classification},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::strip, Column::return_number, Column::return_count}; }
  double halo() const override { return filters::halo(options); }
  // A bin of the points (28), their heights (8), what is in sorting.
  double bytes_per_point() const override { return 64.0; }
  // Plots of 4 m: heights, sparse returns, planes, ranges.
  std::vector<Raster> rasters(const Context& c) const override { return {{"", 4.0, c.tile_side + 2.0 * halo(), 160.0}}; }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::WaterCounts n = filters::classify_water(job.block, job.own, options);
    kept.put_back(job.block, job.own, false, job.tally);
    if (n.water) job.tally.count("water", n.water);
    if (n.ground) job.tally.count("of these ground before", n.ground);
  }
};

}  // namespace

std::unique_ptr<Stage> make_water() { return std::make_unique<Water>(); }
std::unique_ptr<Stage> make_outlier() { return std::make_unique<Outlier>(); }
std::unique_ptr<Stage> make_classify() { return std::make_unique<Classify>(); }

}  // namespace swath::stages
