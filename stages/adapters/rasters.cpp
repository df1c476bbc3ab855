// SPDX-License-Identifier: GPL-3.0-or-later
// Grids beside the models of terrain and surface.
#include "core/error.h"
#include "stages/adapters/adapters.h"
#include "stages/grid_tile.h"
#include "terrain/relief.h"
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

class Relief : public OptionStage<terrain::ReliefOptions> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.relief", "Slope and hillshade of the DTM.",   {Grain::tile}, {}, {},
                           {Product::dtm},   {Product::slope, Product::hillshade}};
    return info;
  }
  double bytes_per_point() const override { return 16.0; }
  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice own = lattice_in(context.grids->cell(Product::dtm), job.box);
    const core::Grid model = context.grids->window(Product::dtm, {own.cell, own.i0 - 1, own.j0 - 1, own.nx + 2, own.ny + 2});
    keep(job, Product::slope, terrain::slope(model, own));
    keep(job, Product::hillshade, terrain::hillshade(model, own, options));
  }
};

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

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
  double bytes_per_point() const override { return 16.0; }
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
  double bytes_per_point() const override { return 8.0; }
  void run_tile(const Context&, TileJob& job) const override {
    const core::Lattice own = lattice_in(options.cell.value, job.box);
    keep(job, Product::pulse_density, terrain::density(job.block, own, true));
    keep(job, Product::return_density, terrain::density(job.block, own, false));
  }
};

class Intensity : public OptionStage<terrain::IntensityOptions> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.intensity",
                           "Image of the intensity of single returns, brought to one range and to perpendicular incidence.",
                           {Grain::tile},
                           {core::Column::intensity, core::Column::return_count, core::Column::flags},
                           {},
                           {Product::points},
                           {Product::intensity}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {core::Column::classification, core::Column::range, core::Column::incidence}; }
  double bytes_per_point() const override { return 8.0; }
  void run_tile(const Context&, TileJob& job) const override {
    const core::Grid grid = terrain::intensity(job.block, lattice_in(options.cell.value, job.box), options);
    if (job.block.range.empty() && job.own > 0) job.tally.count("returns without a range: intensity as recorded", job.own);
    write_grid_tile(job.folder, job.key, grid);
  }
};

}  // namespace

std::unique_ptr<Stage> make_relief() { return std::make_unique<Relief>(); }
std::unique_ptr<Stage> make_canopy() { return std::make_unique<Canopy>(); }
std::unique_ptr<Stage> make_density() { return std::make_unique<Density>(); }
std::unique_ptr<Stage> make_intensity() { return std::make_unique<Intensity>(); }

}  // namespace swath::stages
