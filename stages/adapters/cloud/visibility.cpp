// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/visibility.h"

#include <limits>

#include "core/config/result_visitors.h"
#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/scanner.h"
#include "stages/adapters/cloud/tile_list.h"
#include "stages/adapters/units.h"
#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
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

class Visibility : public OptionStage<filters::VisibilityOptions, BeamCounts, VisibilityFindings> {
 public:
  const Info& info() const override {
    static const Info info{
        "filters.visibility",
        "Follows the beams from the scanner to their returns: noise in space found empty, penetration, gap fraction by height, ground "
        "never "
        "seen.",
        {Grain::tile, Grain::merge},
        {Column::time, Column::strip, Column::return_number, Column::return_count, Column::flags, Column::classification},
        {Column::flags, Column::classification},
        {Product::of<trajectory::Trajectory>(), Product::points},
        {Product::visibility}};
    return info;
  }
  double halo() const override { return filters::halo(options); }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, points 0.7 and 3 m apart, voxels of 1 and 2 m: 36 to 54 bytes for
  // each voxel that the reach holds. Of a raster's cell: 24 layers of counts (16) and their bands (4).
  double bytes_per_point() const override { return 32.0 + filters::visibility_bytes_per_point; }
  std::vector<Raster> rasters(const Context& c) const override {
    const double voxel = options.voxel.value;
    return {
        {"voxel", voxel, c.tile_side + 2.0 * voxel, filters::visibility_bytes_per_column(options), filters::visibility_columns_per_point()},
        {"cell", options.cell.value, c.tile_side, 600.0}};
  }
  std::vector<std::string> products() const override { return {"visibility", "visibility.vrt"}; }

  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice lattice = lattice_in(options.cell.value, job.box);
    filters::Visibility v;
    const std::vector<Eigen::Vector3d> scanner = scanner_.of(context, *record<trajectory::Trajectory>(context), job.block);
    const filters::VisibilityCounts n = filters::trace_visibility(job.block, job.own, scanner, lattice, options, v);
    const core::Grid seen = v.seen();
    BeamCounts counts{n.noise, n.untouched, n.no_position};
    for (const core::Void r : seen.reason) counts.cells += r != core::Void::no_data, counts.never_seen += r == core::Void::never_seen;
    core::count_results(counts, job.tally);
    write_grid_tile(job.folder, job.key, seen);
    write_bands(context, job.key, v);
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    std::vector<std::string> files;
    std::vector<fs::path> tiles;
    double cells = 0, never = 0;
    for (const TileKey key : job.tiles) {
      files.push_back(name(context, key));
      tiles.push_back(context.output / "visibility" / files.back());
      for (const core::Void r : io::read_grid_file(grid_file(job.folder, key)).reason)
        cells += r != core::Void::no_data, never += r == core::Void::never_seen;
    }
    io::write_vrt(context.output / "visibility.vrt", tiles);
    write_list(context.output / "visibility", files);
    if (cells > 0) job.findings = core::reported(VisibilityFindings{never / cells});
  }

 private:
  static std::string name(const Context& context, TileKey key) { return "visibility_" + context.label(key) + ".tif"; }

  void write_bands(const Context& context, TileKey key, const filters::Visibility& v) const {
    const size_t n = v.lattice.size();
    std::vector<std::vector<float>> columns(static_cast<size_t>(v.layers) + 4, std::vector<float>(n));
    const core::Grid seen = v.seen();
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
      bands.push_back({"gap fraction from " + core::format_quantity(core::Dimension::length, k * options.voxel.value), "",
                       &columns[static_cast<size_t>(k) + 4]});
    io::write_raster(context.output / "visibility" / name(context, key), in_crs_units(context, v.lattice), bands, context.product_crs,
                     true);
  }

  ScannerPositions scanner_;
};

}  // namespace

std::unique_ptr<Stage> make_visibility() { return std::make_unique<Visibility>(); }

}  // namespace swath::stages
