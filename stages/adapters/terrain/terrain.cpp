// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/terrain/breaklines.h"
#include "stages/adapters/units.h"
#include "stages/grid_tile.h"
#include "stages/line_comparison.h"
#include "terrain/dsm.h"
#include "terrain/dtm.h"
#include "terrain/voids.h"

namespace swath::stages {
namespace {

/// Cells of a surface by void reason.
struct CellCounts {
  std::array<std::uint64_t, 5> n{};
};

template <class V>
void describe(const CellCounts& r, V& v) {
  using core::if_any;
  v.result("cells with a height", r.n[0], "Cells of the grid that have a height.");
  v.result("void cells: no data", r.n[1], if_any(), "Cells without points around them.");
  v.result("void cells: edge too long", r.n[2], if_any(), "Cells in triangles with an edge longer than max_edge.");
  v.result("void cells: water", r.n[3], if_any(), "Cells on water that has no height.");
  v.result("void cells: ground never seen", r.n[4], if_any(), "Cells where beams came, none of which reached the ground.");
}

CellCounts cells_of(const core::Grid& grid) {
  CellCounts c;
  for (const core::Void r : grid.reason) ++c.n[static_cast<size_t>(r)];
  return c;
}

struct DtmCounts {
  CellCounts cells;
  std::uint64_t shared = 0, tiles_without_sigma = 0;
};

template <class V>
void describe(const DtmCounts& r, V& v) {
  using core::if_any;
  v.result("ground points at the same place as a lower or equal one", r.shared, if_any(), "Ground points that are not triangulated.");
  describe(r.cells, v);
  v.result("tiles whose points carry no sigma: that of the model leaves out the errors that all lines share", r.tiles_without_sigma,
           if_any(), "Tiles whose sigmas follow from the comparison of flight lines.");
}

struct DtmFindings {
  double void_share = std::numeric_limits<double>::quiet_NaN();
};

template <class V>
void describe(const DtmFindings& r, V& v) {
  v.result("void_share", r.void_share, core::share().in_summary().limited_by("voids"),
           "Share of cells without a height that have ground on all sides.");
}

/// Where filters.visibility has run: void cells to which beams came of which none reached the ground.
void mark_never_seen(const Context& context, const TileJob& job, core::Grid& grid) {
  if (!context.grids->has(Product::visibility)) return;
  const double cell = context.grids->cell(Product::visibility);
  terrain::mark_never_seen(grid, context.grids->window(Product::visibility, lattice_in(cell, job.box.grown(cell))));
}

/// Cells of all tiles with a height, and holes: voids with ground on all sides, and those whose ground no beam reached.
struct Cover {
  std::uint64_t known = 0, holes = 0;
};

Cover cover_of(const Context& context, const MergeJob& job) {
  Cover c;
  size_t done = 0;
  for (const TileKey key : job.tiles) {
    context.progress(static_cast<double>(done++) / static_cast<double>(job.tiles.size()), {});
    const core::Grid grid = io::read_grid_file(grid_file(job.folder, key));
    c.known += static_cast<std::uint64_t>(std::count(grid.reason.begin(), grid.reason.end(), core::Void::none));
    for (const core::Void hole : {core::Void::long_edge, core::Void::never_seen})
      c.holes += static_cast<std::uint64_t>(std::count(grid.reason.begin(), grid.reason.end(), hole));
  }
  return c;
}

class Dtm : public OptionStage<terrain::DtmOptions, DtmCounts, DtmFindings> {
 public:
  const Info& info() const override {
    static const Info info{
        "terrain.dtm",
        "Terrain model: the Delaunay TIN of the ground points read at the cell centres, with sigma, count and void reason.",
        {Grain::tile, Grain::merge},
        {core::Column::classification, core::Column::flags},
        {},
        {Product::points},
        {Product::dtm}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {core::Column::sigma_v, core::Column::sigma_h}; }
  std::string_view implied(bool cloud) const override { return cloud && !options.assumed_sigma ? "quality.lines" : ""; }
  double halo() const override { return terrain::halo(options); }
  // Measured 2026-11-22: 290 bytes, tile 1000 m and 4 points per square metre; 195 in tests/stages/memory_test.cpp, tile 500 m, where half
  // of the points are those of the halo that are not triangulated and take a few bytes each.
  double bytes_per_point() const override { return 330.0; }
  double share_of_points(double side) const override {
    const double near = side + 2.0 * terrain::triangulated_border(options) + room, all = side + 2.0 * halo();
    return std::min(1.0, near * near / (all * all));
  }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.25 m: 24 bytes per cell; two counts per cell around the
  // tile for the void reasons.
  std::vector<Raster> rasters(const Context& c) const override {
    return {{"cell", options.cell.value, c.tile_side, 26.0}, {"cell", options.cell.value, c.tile_side + 2.0 * options.max_edge.value, 8.0}};
  }
  double cell() const override { return options.cell.value; }
  bool is_divisible() const override { return true; }
  void join_parts(const Context&, const TileJob& whole, const std::vector<std::filesystem::path>& parts) const override {
    join_grid_parts(whole.folder, whole.key, parts, lattice_in(options.cell.value, whole.box));
  }
  void run_tile(const Context& context, TileJob& job) const override {
    const terrain::Breaklines* lines = lines_.get(context);
    DtmCounts counts;
    counts.tiles_without_sigma = complete_sigmas(context, job) ? 1 : 0;
    core::Grid grid = terrain::dtm(job.block, lattice_in(options.cell.value, job.box), options, lines, &counts.shared);
    mark_never_seen(context, job, grid);
    if (lines) lines->cut(grid);  // beyond the boundary nothing is missed
    counts.cells = cells_of(grid);
    core::count_results(counts, job.tally);
    write_grid_tile(job.folder, job.key, grid);
  }
  void run_merge(const Context& context, MergeJob& job) const override {
    const Cover cover = cover_of(context, job);
    if (cover.known == 0)
      throw core::Error("no triangle of ground points is small enough to give any cell of the DTM a height", context.survey.name,
                        "are there three ground points that are not on one line, closer than max_edge = " +
                            core::format_quantity(core::Dimension::length, options.max_edge.value) + "?");
    job.findings = core::reported(DtmFindings{static_cast<double>(cover.holes) / static_cast<double>(cover.known + cover.holes)});
  }

 private:
  /// Of points that carry none. Do they follow from the comparison of lines?
  bool complete_sigmas(const Context& context, TileJob& job) const {
    if (options.assumed_sigma) {
      const core::Metres along = options.assumed_horizontal.value_or(*options.assumed_sigma);
      quality::give_sigmas(job.block, options.assumed_sigma->value, std::sqrt(2.0) * along.value);
    } else if (const std::optional<quality::KnownLines> lines = known_lines(context); lines && !std::isnan(lines->scatter)) {
      return quality::give_sigmas(job.block, lines->sigma(), lines->horizontal_sigma()) > 0;
    }
    return false;
  }
  static constexpr double room = 10.0;  // m: for triangles that reach beyond the border
  BreaklinesOfRun lines_;
};

class Dsm : public OptionStage<terrain::DsmOptions, CellCounts> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.dsm",
                           "Surface model: the highest first return of each cell.",
                           {Grain::tile},
                           {core::Column::return_number, core::Column::classification, core::Column::flags},
                           {},
                           {Product::points},
                           {Product::dsm}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {core::Column::sigma_v}; }
  double halo() const override { return terrain::halo(options); }
  double bytes_per_point() const override { return 240.0; }
  // Measured as above, cells of 0.5 m: 42 bytes per cell.
  std::vector<Raster> rasters(const Context& c) const override { return {{"cell", options.cell.value, c.tile_side + 2.0 * halo(), 46.0}}; }
  double cell() const override { return options.cell.value; }
  bool is_divisible() const override { return true; }
  void join_parts(const Context&, const TileJob& whole, const std::vector<std::filesystem::path>& parts) const override {
    join_grid_parts(whole.folder, whole.key, parts, lattice_in(options.cell.value, whole.box));
  }
  void run_tile(const Context&, TileJob& job) const override {
    const core::Grid grid = terrain::dsm(job.block, lattice_in(options.cell.value, job.box), options);
    core::count_results(cells_of(grid), job.tally);
    write_grid_tile(job.folder, job.key, grid);
  }
};

}  // namespace

std::unique_ptr<Stage> make_dtm() { return std::make_unique<Dtm>(); }
std::unique_ptr<Stage> make_dsm() { return std::make_unique<Dsm>(); }

}  // namespace swath::stages
