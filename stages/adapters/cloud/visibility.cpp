// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/visibility.h"

#include <limits>

#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/scanner.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

using core::Column;

struct BeamCounts {
  core::Flagged noise;
  core::Kept untouched, no_position;
  std::uint64_t cells = 0, never_seen = 0;
};

template <class V>
void describe(const BeamCounts& r, V& v) {
  using core::if_any;
  v.result("high noise", r.noise, "Returns in space that other beams found empty.");
  v.result("withheld or noise already, not looked at", r.untouched, if_any(), "Returns that keep their class.");
  v.result("outside the trajectory: beam not followed", r.no_position, if_any(), "Returns at times without a position of the scanner.");
  v.result("cells with beams", r.cells, "Cells that a beam came to.");
  v.result("cells whose ground was never seen", r.never_seen, if_any(), "Of those: cells where no beam reached the ground.");
}

struct VisibilityFindings {
  double never_seen_share = std::numeric_limits<double>::quiet_NaN();
};

template <class V>
void describe(const VisibilityFindings& r, V& v) {
  v.result("never_seen_share", r.never_seen_share, core::share().in_summary(), "Share of cells with beams whose ground was never seen.");
}

void write_bands(const TileRasters& out, TileKey key, const filters::Visibility& v, const core::Grid& seen, double voxel) {
  const size_t n = v.lattice.size();
  std::vector<std::vector<float>> columns(static_cast<size_t>(v.layers) + 4, std::vector<float>(n));
  for (size_t c = 0; c < n; ++c) {
    columns[0][c] = static_cast<float>(v.penetration(c));
    columns[1][c] = static_cast<float>(v.gap_fraction(c));
    columns[2][c] = static_cast<float>(v.pulses[c]);
    columns[3][c] = seen.reason[c] == core::Void::no_data ? std::numeric_limits<float>::quiet_NaN()
                                                          : (seen.reason[c] == core::Void::never_seen ? 1.0f : 0.0f);
    for (int k = 0; k < v.layers; ++k) columns[static_cast<size_t>(k) + 4][c] = static_cast<float>(v.gap(c, k));
  }
  std::vector<io::RasterBand> bands{{"penetration rate", "", &columns[0]},
                                    {"gap fraction", "", &columns[1]},
                                    {"pulses", "", &columns[2]},
                                    {"ground never seen", "", &columns[3]}};
  for (int k = 0; k < v.layers; ++k)
    bands.push_back(
        {"gap fraction from " + core::format_quantity(core::Dimension::length, k * voxel), "", &columns[static_cast<size_t>(k) + 4]});
  out.write(key, v.lattice, bands);
}

Tiled<BeamCounts, Product::visibility> follow_beams(TileJob& job, const Context& context, const trajectory::Trajectory& flown,
                                                    const filters::VisibilityOptions& o, RunCache& cache) {
  filters::Visibility v;
  const std::vector<Eigen::Vector3d> scanner = scanner_positions(context, flown, job.block, cache);
  const filters::VisibilityCounts n = filters::trace_visibility(job.block, job.own, scanner, lattice_in(o.cell.value, job.box), o, v);
  core::Grid seen = v.seen();
  BeamCounts counts{n.noise, n.untouched, n.no_position};
  for (const core::Void r : seen.reason) counts.cells += r != core::Void::no_data, counts.never_seen += r == core::Void::never_seen;
  write_bands({context, "visibility"}, job.key, v, seen, o.voxel.value);
  return {counts, {std::move(seen)}};
}
VisibilityFindings sum_visibility(const MergeJob& job, const Context& context) {
  double cells = 0, never = 0;
  for (const TileKey key : job.tiles)
    for (const core::Void r : io::read_grid_file(grid_file(job.folder, key)).reason)
      cells += r != core::Void::no_data, never += r == core::Void::never_seen;
  TileRasters{context, "visibility"}.finish(job.tiles);
  return {never / cells};  // not a number without cells
}
// Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, points 0.7 and 3 m apart, voxels of 1 and 2 m: 36 to 54 bytes for
// each voxel that the reach holds. Of a raster's cell: 24 layers of counts (16) and their bands (4).
TileMemory beam_memory(const filters::VisibilityOptions& o, const Context& c) {
  const double voxel = o.voxel.value, columns = filters::visibility_columns_per_point();
  return {32.0 + filters::visibility_bytes_per_point,
          {{"voxel", voxel, c.tile_side + 2.0 * voxel, filters::visibility_bytes_per_column(o), columns},
           {"cell", o.cell.value, c.tile_side, 600.0}}};
}

}  // namespace

Entry visibility_stage() {
  return tile<follow_beams, sum_visibility>(
      "filters.visibility",
      "Follows the beams from the scanner to their returns: noise in space found empty, penetration, gap fraction by height, ground never "
      "seen.",
      {.columns = {.needs = {Column::time, Column::strip, Column::return_number, Column::return_count, Column::flags,
                             Column::classification},
                   .gives = {Column::flags, Column::classification}},
       .memory = beam_memory,
       .products = [](const filters::VisibilityOptions&) {
         return std::vector<std::string>{"visibility", "visibility.vrt"};
       }});
}

}  // namespace swath::stages
