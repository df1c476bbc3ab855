// SPDX-License-Identifier: GPL-3.0-or-later
// Density of first returns, of each flight line and of all, for the stages that judge by the spacing of pulses.
#include "io/text/value_file.h"
#include "quality/pulse_density.h"
#include "quality/repeated_returns.h"
#include "report/value_map.h"
#include "stages/adapters/quality/quality_stages.h"
#include "stages/map_overview.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

using core::Column;

constexpr const char* swath_density_name = "swath_density";

struct PulseDensityOptions {
  core::Metres cell{5.0};
};

template <class V>
void describe(PulseDensityOptions& o, V& v) {
  v.option("cell", o.cell, core::within(0.5, 100.0), "Side of the cells in which first returns are counted.");
}

double halo(const PulseDensityOptions& o) { return 1.5 * o.cell.value; }

void count_first_returns(const TileJob& job, const Context& context, const PulseDensityOptions& o) {
  const core::Lattice window = lattice_in(o.cell.value, job.box);
  const quality::PulseCells cells = quality::count_pulses(job.block, window, quality::repeated_first_returns(job.block));
  std::vector<float> lines(window.size());
  for (size_t c = 0; c < lines.size(); ++c) lines[c] = static_cast<float>(cells.density.count[c]);
  TileRasters{context, swath_density_name}.write(job.key, window,
                                                 {{"first returns per m2", "1/m2", &cells.density.height},
                                                  {"lines", "", &lines},
                                                  {"first returns of the densest line per m2", "1/m2", &cells.single.height}});
  write_rows(piece_file(job.folder, job.key, "pulses"), cells.lines, cells.bins);
  write_grid_tile(job.folder / "map", job.key, cells.density);
}

quality::SwathDensity judge_first_returns(const MergeJob& job, const Context& context, const PulseDensityOptions& o) {
  std::vector<quality::PulseSums> lines;
  std::vector<quality::PulseBin> bins;
  for (const TileKey key : job.tiles) read_rows(piece_file(job.folder, key, "pulses"), lines, bins);
  quality::SwathDensity found = quality::judge_density(lines, bins, o.cell.value);
  TileRasters{context, swath_density_name}.finish(job.tiles);
  io::write_text_file(context.output / "density.json", io::to_json(core::reported(found)));
  const core::Grid map = overview_of(job.folder / "map", job.tiles, o.cell.value);
  report::ValueMapOptions look;
  look.title = "First returns per m2 of all lines";
  look.value_unit = "per m2";
  look.void_name = "none";
  write_picture(context, swath_density_name, report::draw(report::value_map(map.lattice, map.height, {}, look)));
  return found;
}

}  // namespace

Entry pulse_density_stage() {
  return tile<count_first_returns, judge_first_returns>(
      "quality.density", "Density and spacing of first returns, of each flight line and of all together; map as GeoTIFF.",
      {.columns = {.needs = {Column::flags},
                   .reads = {Column::strip, Column::return_number, Column::classification, Column::time, Column::intensity,
                             Column::return_count, Column::scan_angle, Column::red, Column::green, Column::blue, Column::user_data}},
       .memory =
           [](const PulseDensityOptions& o, const Context& c) {
             // Per cell: counts of up to 20 lines, two grids, GDAL's blocks.
             // Per point: two slots and a mark for duplicates.
             return TileMemory{26.0, {{"cell", o.cell.value, c.tile_side, 150.0}}};
           },
       .products =
           [](const PulseDensityOptions&) {
             const std::string name = swath_density_name;
             return std::vector<std::string>{"density.json", name, name + ".vrt", name + ".png"};
           }});
}

}  // namespace swath::stages
