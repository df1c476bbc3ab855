// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/error.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/terrain/breaklines.h"
#include "stages/line_comparison.h"
#include "stages/tile.h"
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

/// Points of the tiles, by whether the model can use them. The names serve to find the counts again.
constexpr const char *all_points = "points", *withheld_points = "points that are withheld: not used",
                     *noise_points = "points of noise: not used", *ground_points = "points of the model's classes";
struct PointCounts {
  std::uint64_t all = 0, withheld = 0, noise = 0, ground = 0;
};

template <class V>
void describe(const PointCounts& r, V& v) {
  v.result(all_points, r.all, "Points of the tiles.");
  v.result(withheld_points, r.withheld, core::if_any(), "Points with the flag withheld.");
  v.result(noise_points, r.noise, core::if_any(), "Points of class 7 or 18.");
  v.result(ground_points, r.ground, "Points of `classes` that are neither withheld nor noise.");
}

PointCounts points_of(const core::Block& b, size_t own, const std::vector<int>& classes) {
  PointCounts n;
  n.all = own;
  for (size_t i = 0; i < own; ++i) {
    if (core::is_usable(b, i))
      n.ground += b.classification.empty() || std::find(classes.begin(), classes.end(), b.classification[i]) != classes.end();
    else
      ++(!b.flags.empty() && (b.flags[i] & core::flag::withheld) != 0 ? n.withheld : n.noise);
  }
  return n;
}

struct DtmCounts {
  PointCounts points;
  CellCounts cells;
  std::uint64_t shared = 0, tiles_without_sigma = 0;
};

template <class V>
void describe(const DtmCounts& r, V& v) {
  using core::if_any;
  describe(r.points, v);
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
  const In<Product::visibility> seen{*context.grids};
  terrain::mark_never_seen(grid, seen.over(job.box.grown(seen.cell())));
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

/// Of points that carry none. Do they follow from the comparison of lines?
bool complete_sigmas(const Context& context, TileJob& job, const terrain::DtmOptions& o) {
  if (o.assumed_sigma) {
    const core::Metres along = o.assumed_horizontal.value_or(*o.assumed_sigma);
    quality::give_sigmas(job.block, o.assumed_sigma->value, std::sqrt(2.0) * along.value);
  } else if (const std::optional<quality::KnownLines> lines = known_lines(context); lines && !std::isnan(lines->scatter)) {
    return quality::give_sigmas(job.block, lines->sigma(), lines->horizontal_sigma()) > 0;
  }
  return false;
}

Tiled<DtmCounts, Product::dtm> model_terrain(TileJob& job, const Context& context, const terrain::DtmOptions& o, RunCache& cache) {
  const terrain::Breaklines* lines = breaklines_of(context, cache);
  DtmCounts counts;
  counts.points = points_of(job.block, job.own, o.classes);
  counts.tiles_without_sigma = complete_sigmas(context, job, o) ? 1 : 0;
  core::Grid grid = terrain::dtm(job.block, lattice_in(o.cell.value, job.box), o, lines, &counts.shared);
  mark_never_seen(context, job, grid);
  if (lines) lines->cut(grid);  // beyond the boundary nothing is missed
  counts.cells = cells_of(grid);
  return {counts, {std::move(grid)}};
}
/// Throws where no point can be of the model, for the first reason that holds for all of them.
void expect_ground_points(const core::Tally& of_tiles, const std::string& survey, const std::string& classes) {
  const PointCounts n{of_tiles.of(all_points), of_tiles.of(withheld_points), of_tiles.of(noise_points), of_tiles.of(ground_points)};
  if (n.all == 0 || n.ground > 0) return;
  const std::string all = n.all == 1 ? "the only point" : "all " + std::to_string(n.all) + " points", are = n.all == 1 ? " is " : " are ";
  if (n.withheld == n.all)
    throw core::Error(all + are + "withheld: there is nothing to make a terrain model of", survey,
                      "another program has set their flag withheld, or filters.crop leaves none: `swath info FILE` counts them");
  if (n.noise == n.all)
    throw core::Error(all + are + "noise (class 7 or 18): there is nothing to make a terrain model of", survey,
                      "`swath info FILE` lists the classes of the file; where filters.noise has found them, are heights and units right?");
  if (n.withheld + n.noise == n.all)
    throw core::Error(all + are + "withheld (" + std::to_string(n.withheld) + ") or noise (" + std::to_string(n.noise) +
                          "): there is nothing to make a terrain model of",
                      survey, "`swath info FILE` counts the withheld points of a file and lists its classes");
  const std::string others = n.withheld + n.noise > 0 ? "of other classes, withheld or noise"
                             : n.all == 1             ? "of another class"
                                                      : "of other classes";
  throw core::Error("no triangle of ground points (class " + classes + "): " + all + are + others, survey,
                    "a ground filter before terrain.dtm finds ground where there is any, but not in points on one line or at one place; "
                    "`swath info FILE` lists the classes of a file, terrain.dtm's `classes` says which of them are terrain");
}

DtmFindings judge_terrain(const MergeJob& job, const Context& context, const terrain::DtmOptions& o) {
  const Cover cover = cover_of(context, job);
  if (cover.known == 0) {
    std::string classes;
    for (const int c : o.classes) classes += (classes.empty() ? "" : ", ") + std::to_string(c);
    expect_ground_points(job.of_tiles, context.survey.name, classes);
    throw core::Error("no triangle of ground points (class " + classes + ") is small enough to give any cell of the DTM a height",
                      context.survey.name,
                      "are there points of that class (`swath info FILE` lists the classes), three of them not on one line and closer than "
                      "max_edge = " +
                          core::format_quantity(core::Dimension::length, o.max_edge.value) + "?");
  }
  return {static_cast<double>(cover.holes) / static_cast<double>(cover.known + cover.holes)};
}
// Measured 2026-11-22: 290 bytes per point, tile 1000 m and 4 points per square metre; 195 in tests/stages/memory_test.cpp, tile 500 m,
// where half of the points are those of the halo that are not triangulated and take a few bytes each. There, too, tile 200 m, cells of
// 0.25 m: 24 bytes per cell; two counts per cell around the tile for the void reasons.
TileMemory dtm_memory(const terrain::DtmOptions& o, const Context& c) {
  constexpr double room = 10.0;  // m: for triangles that reach beyond the border
  const double near = c.tile_side + 2.0 * terrain::triangulated_border(o) + room, all = c.tile_side + 2.0 * terrain::halo(o);
  return {330.0,
          {{"cell", o.cell.value, c.tile_side, 26.0}, {"cell", o.cell.value, c.tile_side + 2.0 * o.max_edge.value, 8.0, 0.0, "max_edge"}},
          std::min(1.0, near * near / (all * all))};
}

Tiled<CellCounts, Product::dsm> model_surface(const TileJob& job, const terrain::DsmOptions& o) {
  core::Grid grid = terrain::dsm(job.block, lattice_in(o.cell.value, job.box), o);
  return {cells_of(grid), {std::move(grid)}};
}
/// Measured as above, cells of 0.5 m: 42 bytes per cell.
TileMemory dsm_memory(const terrain::DsmOptions& o, const Context& c) {
  return {240.0, {{"cell", o.cell.value, c.tile_side + 2.0 * terrain::halo(o), 46.0}}};
}

}  // namespace

Entry dtm_stage() {
  return tile<model_terrain, judge_terrain>(
      "terrain.dtm", "Terrain model: the Delaunay TIN of the ground points read at the cell centres, with sigma, count and void reason.",
      {.columns = {.needs = {core::Column::classification, core::Column::flags}, .reads = {core::Column::sigma_v, core::Column::sigma_h}},
       .memory = dtm_memory,
       .implied = [](const terrain::DtmOptions& o, bool cloud) -> std::string_view {
         return cloud && !o.assumed_sigma ? "quality.lines" : "";
       }});
}
Entry dsm_stage() {
  return tile<model_surface>("terrain.dsm", "Surface model: the highest first return of each cell.",
                             {.columns = {.needs = {core::Column::return_number, core::Column::classification, core::Column::flags},
                                          .reads = {core::Column::sigma_v}},
                              .memory = dsm_memory});
}

}  // namespace swath::stages
