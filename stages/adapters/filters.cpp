// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.h"
#include "filters/height.h"
#include "filters/noise.h"
#include "filters/returns.h"
#include "filters/smrf.h"
#include "io/las_block.h"
#include "io/las_header.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/kept_classes.h"

namespace swath::stages {
namespace {

using core::Column;

class Smrf : public OptionStage<Keeping<filters::SmrfOptions>> {
 public:
  const Info& info() const override {
    static const Info info{"filters.smrf",
                           "Ground points by the Simple Morphological Filter (Pingel, Clarke and McBride 2013).",
                           {Grain::tile},
                           {Column::flags},
                           {Column::classification},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::return_number, Column::return_count}; }
  double halo() const override { return filters::halo(options); }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.25 and 1 m: 62 and 63 bytes per cell of tile and halo,
  // the same for points 0.7 m and 3 m apart.
  double bytes_per_point() const override { return 16.0; }
  std::vector<Raster> rasters(const Context& c) const override { return {{"cell", options.cell.value, c.tile_side + 2.0 * halo(), 66.0}}; }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::SmrfCounts n = filters::classify_ground_smrf(job.block, job.own, options);
    kept.put_back(job.block, job.own, true, job.tally);
    job.tally.count("ground", n.ground);
    job.tally.count("not ground", n.object);
    if (n.untouched) job.tally.count("withheld or noise, not looked at", n.untouched);
    if (n.no_surface) job.tally.count("no ground within reach", n.no_surface);
  }
};

struct ReturnsStageOptions : filters::ReturnsOptions {
  bool repair_clouds = false;
};

template <class V>
void describe(ReturnsStageOptions& o, V& v) {
  describe(static_cast<filters::ReturnsOptions&>(o), v);
  v.option("repair_clouds", o.repair_clouds, "Repair numbers of point clouds, too, where the points' times distinguish the pulses.");
}

class Returns : public OptionStage<ReturnsStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "filters.returns",
        "First, last, only and intermediate returns: missing or inconsistent numbers repaired or flagged, returns per pulse by line.",
        {Grain::strip},
        {Column::time, Column::return_number, Column::return_count},
        {Column::return_number, Column::return_count, Column::flags},
        {Product::points},
        {}};
    return info;
  }
  void run_strip(const Context& context, StripBatch& batch, core::Tally& tally) const override {
    // A cloud may be cropped, thinned or dated to the second: its numbers are its maker's.
    const bool is_cloud = context.source && context.source->info().makes(Product::points);
    if (!is_cloud) {
      repair(batch.block, options, tally);
    } else if (options.repair_clouds) {
      filters::ReturnsOptions careful = options;
      careful.gaps = filters::Gaps::keep;  // returns beyond a crop's rim are absent rightly
      if (filters::tells_pulses(batch.block))
        repair(batch.block, careful, tally);
      else
        tally.count("times do not tell pulses apart, return numbers left as they are", batch.block.size());
    }
    filters::ReturnStatistics statistics;
    statistics.add(batch.block);
    for (const auto& [line, s] : statistics.strips()) {
      const std::string name = "line " + std::to_string(line) + ": ";
      for (size_t k = 1; k < s.pulses.size(); ++k)
        if (s.pulses[k]) tally.count(name + "pulses of " + std::to_string(k) + (k == 1 ? " return" : " returns"), s.pulses[k]);
      tally.count(name + "first returns", s.first);
      tally.count(name + "last returns", s.last);
      tally.count(name + "only returns", s.only);
      if (s.intermediate) tally.count(name + "intermediate returns", s.intermediate);
    }
  }

 private:
  static void repair(core::Block& block, const filters::ReturnsOptions& o, core::Tally& tally) {
    const filters::RepairCounts n = filters::repair_returns(block, o);
    if (n.repaired) tally.count("return numbers repaired", n.repaired);
    if (n.inconsistent) tally.count("return numbers inconsistent, flagged", n.inconsistent);
  }
};

class Noise : public OptionStage<Keeping<filters::NoiseOptions>> {
 public:
  const Info& info() const override {
    static const Info info{"filters.noise",
                           "Isolated points, low points and ranges outside the gate: flagged and classed as noise, never deleted.",
                           {Grain::tile},
                           {Column::flags, Column::classification},
                           {Column::flags, Column::classification},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override {
    return options.range_min || options.range_max ? core::ColumnSet{Column::range} : core::ColumnSet{};
  }
  void check(const Context& context) const override {
    // Ranges come from raw records; a cloud has them only where its files say so.
    if ((!options.range_min && !options.range_max) || !context.source || !context.source->info().makes(Product::points)) return;
    for (const io::PointFile& f : context.survey.points) {
      const std::filesystem::path file = io::resolve(context.survey, f.file);
      std::vector<std::string> ignored;
      if (!io::read_las_header(file, ignored).extra_offset(io::las_name::range))
        throw core::usage_error("filters.noise: range_min and range_max need the points' ranges, which the file does not have",
                                file.string(), "leave the range gate out, or start from raw laser records");
    }
  }
  double halo() const override { return filters::halo(options); }
  double bytes_per_point() const override { return 96.0; }
  // Starts and lowest points of the cells of one judgement, starts of the other's. Measured 2026-11-22 with tests/stages/memory_test.cpp,
  // both radii 0.5 m: 32 bytes per cell.
  std::vector<Raster> rasters(const Context& c) const override {
    const double side = c.tile_side + 2.0 * halo();
    return {{"low_radius", options.low_radius.value, side, 34.0}, {"radius", options.radius.value, side, 8.0}};
  }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::NoiseCounts n = filters::flag_noise(job.block, job.own, options);
    kept.put_back(job.block, job.own, false, job.tally);
    job.tally.count("low noise", n.low_noise);
    job.tally.count("high noise", n.high_noise);
    if (n.isolated) job.tally.count("isolated", n.isolated);
    if (n.low_point) job.tally.count("low points", n.low_point);
    if (n.range_gate) job.tally.count("outside the range gate", n.range_gate);
    if (n.untouched) job.tally.count("withheld or noise already, not looked at", n.untouched);
  }
};

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

class HeightAboveGround : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"filters.hag_dem",
                           "Height of every point above the DTM, bilinear between cell centres.",
                           {Grain::tile},
                           {},
                           {Column::height},
                           {Product::points, Product::dtm},
                           {}};
    return info;
  }
  double bytes_per_point() const override { return 16.0; }
  std::vector<Raster> rasters(const Context& c) const override { return window_of(c, Product::dtm, 0); }
  void run_tile(const Context& context, TileJob& job) const override {
    const double cell = context.grids->cell(Product::dtm);
    const core::Grid terrain = context.grids->window(Product::dtm, lattice_in(cell, job.box.grown(1.5 * cell)));
    const std::uint64_t unknown = filters::height_above(terrain, job.block, job.own);
    if (unknown) job.tally.count("above a void of the DTM: height unknown", unknown);
  }
};

}  // namespace

std::unique_ptr<Stage> make_returns() { return std::make_unique<Returns>(); }
std::unique_ptr<Stage> make_noise() { return std::make_unique<Noise>(); }
std::unique_ptr<Stage> make_smrf() { return std::make_unique<Smrf>(); }
std::unique_ptr<Stage> make_hag_dem() { return std::make_unique<HeightAboveGround>(); }

}  // namespace swath::stages
