// SPDX-License-Identifier: GPL-3.0-or-later
// Grids beside the models of terrain and surface.
#include "core/relief.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/scanner.h"
#include "stages/tile.h"
#include "terrain/return_grids.h"

namespace swath::stages {
namespace {

using core::Column;

using Relief = Tiled<NoResults, Product::slope, Product::hillshade>;
Relief shade_relief(const TileJob& job, const In<Product::dtm>& terrain, const core::Light& light) {
  const core::Lattice own = terrain.lattice(job.box);
  const core::Grid model = terrain.window({own.cell, own.i0 - 1, own.j0 - 1, own.nx + 2, own.ny + 2});
  return {{}, {core::slope(model, own), core::hillshade(model, own, light)}};
}

Tiled<NoResults, Product::canopy> model_canopy(const TileJob& job, const In<Product::dtm>& terrain, const In<Product::dsm>& surface) {
  return {{}, {terrain::canopy(surface.over(job.box), terrain.over(job.box))}};
}

using Densities = Tiled<NoResults, Product::pulse_density, Product::return_density>;
Densities count_density(const TileJob& job, const terrain::DensityOptions& o) {
  const core::Lattice own = lattice_in(o.cell.value, job.box);
  return {{}, {terrain::density(job.block, own, o, true), terrain::density(job.block, own, o, false)}};
}
// Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.5 m: 30 bytes per cell with one grid at a time, 32 with
// both (intensity 34); the search for returns on all sides has two counts per cell.
TileMemory density_memory(const terrain::DensityOptions& o, const Context& c) {
  return {8.0, {{"cell", o.cell.value, c.tile_side, 32.0}, {"cell", o.cell.value, c.tile_side + 2.0 * terrain::halo(o), 8.0}}};
}

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

constexpr auto intensity_halo = [](const terrain::IntensityOptions& o) { return o.cell.value; };  // cells reach over the tile's border

/// The column incidence, which is to the vertical, by the terrain model where the run has one and knows where the scanner was.
void meet_terrain(const Context& context, TileJob& job, const trajectory::Trajectory* flown, const terrain::IntensityOptions& o,
                  RunCache& cache, IntensityCounts& counts) {
  if (o.steepest.value == 0.0 || job.own == 0) return;
  if (!flown || !context.grids->has(Product::dtm)) {
    (job.block.incidence.empty() ? counts.without_incidence : counts.without_terrain) = job.own;
    return;
  }
  const In<Product::dtm> terrain{*context.grids};
  const core::Grid model = terrain.over(job.box.grown(intensity_halo(o) + 2.0 * terrain.cell()));
  terrain::set_incidence(job.block, model, scanner_positions(context, *flown, job.block, cache));
}

Tiled<IntensityCounts, Product::intensity> image_intensity(TileJob& job, const Context& context, const trajectory::Trajectory* flown,
                                                           const terrain::IntensityOptions& o, RunCache& cache) {
  IntensityCounts counts;
  meet_terrain(context, job, flown, o, cache, counts);
  if (job.block.range.empty()) counts.without_range = job.own;
  return {counts, {terrain::intensity(job.block, lattice_in(o.cell.value, job.box), o)}};
}
/// Of points: scanner positions and incidence.
TileMemory intensity_memory(const terrain::IntensityOptions& o, const Context& c) {
  TileMemory out{32.0, window_of(c, Product::dtm, 0)};
  out.rasters.push_back({"cell", o.cell.value, c.tile_side, 36.0});
  return out;
}

}  // namespace

Entry relief_stage() {
  return tile<shade_relief>("terrain.relief", "Slope and hillshade of the DTM.", {.memory = [](const core::Light&, const Context& c) {
                              return TileMemory{0.0, window_of(c, Product::dtm, 0)};
                            }});
}
Entry canopy_stage() {
  return tile<model_canopy>("terrain.canopy", "Canopy height model: the surface model less the terrain model, not below 0.",
                            {.memory = [](const NoOptions&, const Context& c) {
                              return TileMemory{0.0, window_of(c, Product::dtm, 2)};
                            }});
}
Entry density_stage() {
  return tile<count_density>(
      "terrain.density", "Density of pulses (first returns) and of returns per square metre.",
      {.columns = {.needs = {Column::return_number, Column::flags}, .reads = {Column::classification}}, .memory = density_memory});
}
Entry intensity_stage() {
  return tile<image_intensity>(
      "terrain.intensity", "Image of the intensity of single returns, brought to one range and to perpendicular incidence on the terrain.",
      {.columns = {.needs = {Column::time, Column::intensity, Column::return_count, Column::flags},
                   .reads = {Column::classification, Column::range, Column::incidence}},
       .halo = intensity_halo,
       .memory = intensity_memory});
}

}  // namespace swath::stages
