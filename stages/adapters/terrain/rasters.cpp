// SPDX-License-Identifier: GPL-3.0-or-later
// Grids beside the models of terrain and surface.
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/relief.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/scanner.h"
#include "stages/grid_tile.h"
#include "terrain/return_grids.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

/// Of a stage that gives several grids each has a folder of its own.
void keep(const TileJob& job, Product product, const core::Grid& grid) {
  const fs::path folder = job.folder / name_of(product);
  fs::create_directories(folder);
  write_grid_tile(folder, job.key, grid);
}

class Relief : public OptionStage<core::Light> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.relief", "Slope and hillshade of the DTM.",   {Grain::tile}, {}, {},
                           {Product::dtm},   {Product::slope, Product::hillshade}};
    return info;
  }
  double bytes_per_point() const override { return 0.0; }
  std::vector<Raster> rasters(const Context& c) const override { return window_of(c, Product::dtm, 0); }
  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice own = lattice_in(context.grids->cell(Product::dtm), job.box);
    const core::Grid model = context.grids->window(Product::dtm, {own.cell, own.i0 - 1, own.j0 - 1, own.nx + 2, own.ny + 2});
    keep(job, Product::slope, core::slope(model, own));
    keep(job, Product::hillshade, core::hillshade(model, own, options));
  }
};

class Canopy : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.canopy",
                           "Canopy height model: the surface model less the terrain model, not below 0.",
                           {Grain::tile},
                           {},
                           {},
                           {Product::dtm, Product::dsm},
                           {Product::canopy}};
    return info;
  }
  double bytes_per_point() const override { return 0.0; }
  std::vector<Raster> rasters(const Context& c) const override { return window_of(c, Product::dtm, 2); }
  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice of_surface = lattice_in(context.grids->cell(Product::dsm), job.box);
    const core::Lattice of_terrain = lattice_in(context.grids->cell(Product::dtm), job.box);
    write_grid_tile(job.folder, job.key,
                    terrain::canopy(context.grids->window(Product::dsm, of_surface), context.grids->window(Product::dtm, of_terrain)));
  }
};

class Density : public OptionStage<terrain::DensityOptions> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.density",
                           "Density of pulses (first returns) and of returns per square metre.",
                           {Grain::tile},
                           {core::Column::return_number, core::Column::flags},
                           {},
                           {Product::points},
                           {Product::pulse_density, Product::return_density}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {core::Column::classification}; }
  double halo() const override { return terrain::halo(options); }
  double cell() const override { return options.cell.value; }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.5 m: 30 bytes per cell (intensity 34); the search for
  // returns on all sides has two counts per cell.
  double bytes_per_point() const override { return 8.0; }
  std::vector<Raster> rasters(const Context& c) const override {
    return {{"cell", options.cell.value, c.tile_side, 32.0}, {"cell", options.cell.value, c.tile_side + 2.0 * halo(), 8.0}};
  }
  bool is_divisible() const override { return true; }
  void join_parts(const Context&, const TileJob& whole, const std::vector<fs::path>& parts) const override {
    for (const Product p : {Product::pulse_density, Product::return_density}) {
      std::vector<fs::path> of_parts;
      for (const fs::path& part : parts) of_parts.push_back(part / name_of(p));
      fs::create_directories(whole.folder / name_of(p));
      join_grid_parts(whole.folder / name_of(p), whole.key, of_parts, lattice_in(options.cell.value, whole.box));
    }
  }
  void run_tile(const Context&, TileJob& job) const override {
    const core::Lattice own = lattice_in(options.cell.value, job.box);
    keep(job, Product::pulse_density, terrain::density(job.block, own, options, true));
    keep(job, Product::return_density, terrain::density(job.block, own, options, false));
  }
};

/// Returns whose intensity is not brought to one range and to perpendicular incidence.
struct IntensityCounts {
  std::uint64_t without_range = 0, without_incidence = 0, without_terrain = 0;
};

template <class V>
void describe(const IntensityCounts& r, V& v) {
  using core::if_any;
  v.result("returns without a range: intensity as recorded", r.without_range, if_any(), "Returns whose range is unknown.");
  v.result("returns without an incidence: intensity not brought to perpendicular", r.without_incidence, if_any(),
           "Returns whose angle of incidence is unknown.");
  v.result("returns without terrain model or trajectory: incidence to the vertical", r.without_terrain, if_any(),
           "Returns that are taken to meet level ground.");
}

class Intensity : public OptionStage<terrain::IntensityOptions, IntensityCounts> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.intensity",
                           "Image of the intensity of single returns, brought to one range and to perpendicular incidence on the terrain.",
                           {Grain::tile},
                           {core::Column::time, core::Column::intensity, core::Column::return_count, core::Column::flags},
                           {},
                           {Product::points},
                           {Product::intensity},
                           {Product::of<trajectory::Trajectory>()}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {core::Column::classification, core::Column::range, core::Column::incidence}; }
  double halo() const override { return options.cell.value; }  // cells reach over the tile's border
  double cell() const override { return options.cell.value; }
  double bytes_per_point() const override { return 32.0; }  // scanner positions and incidence
  std::vector<Raster> rasters(const Context& c) const override {
    std::vector<Raster> out = window_of(c, Product::dtm, 0);
    out.push_back({"cell", options.cell.value, c.tile_side, 36.0});
    return out;
  }
  bool is_divisible() const override { return true; }
  void join_parts(const Context&, const TileJob& whole, const std::vector<fs::path>& parts) const override {
    join_grid_parts(whole.folder, whole.key, parts, lattice_in(options.cell.value, whole.box));
  }
  void run_tile(const Context& context, TileJob& job) const override {
    IntensityCounts counts;
    meet_terrain(context, job, counts);
    const core::Grid grid = terrain::intensity(job.block, lattice_in(options.cell.value, job.box), options);
    if (job.block.range.empty()) counts.without_range = job.own;
    core::count_results(counts, job.tally);
    write_grid_tile(job.folder, job.key, grid);
  }

 private:
  /// The column incidence, which is to the vertical, by the terrain model where the run has one and knows where the scanner was.
  void meet_terrain(const Context& context, TileJob& job, IntensityCounts& counts) const {
    if (options.steepest.value == 0.0 || job.own == 0) return;
    const trajectory::Trajectory* flown = record<trajectory::Trajectory>(context);
    if (!flown || !context.grids->has(Product::dtm)) {
      (job.block.incidence.empty() ? counts.without_incidence : counts.without_terrain) = job.own;
      return;
    }
    const double cell = context.grids->cell(Product::dtm);
    const double border = halo() + 2.0 * cell;
    const core::Grid model = context.grids->window(Product::dtm, lattice_in(cell, job.box.grown(border)));
    terrain::set_incidence(job.block, model, scanner_.of(context, *flown, job.block));
  }
  ScannerPositions scanner_;
};

}  // namespace

std::unique_ptr<Stage> make_relief() { return std::make_unique<Relief>(); }
std::unique_ptr<Stage> make_canopy() { return std::make_unique<Canopy>(); }
std::unique_ptr<Stage> make_density() { return std::make_unique<Density>(); }
std::unique_ptr<Stage> make_intensity() { return std::make_unique<Intensity>(); }

}  // namespace swath::stages
