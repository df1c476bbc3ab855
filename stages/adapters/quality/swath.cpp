// SPDX-License-Identifier: GPL-3.0-or-later
// What the swaths are like by themselves and against one another: differences where they overlap, distribution of the first returns, voids.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "io/text/value_file.h"
#include "quality/overlap_cells.h"
#include "quality/quality_level.h"
#include "quality/void_areas.h"
#include "report/difference_map.h"
#include "report/value_map.h"
#include "stages/adapters/quality/quality_stages.h"
#include "stages/adapters/quality/swath_files.h"
#include "stages/adapters/terrain/breaklines.h"
#include "stages/map_overview.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

using core::Column;

constexpr double widest_measured = 3.0;   // m: a measured spacing that the points around a tile suffice for
constexpr double planned_spacing = 0.35;  // m, for the memory of a survey whose spacing is not known yet
constexpr double cells_for_least = 1.5;   // times the least number of returns that a cell must hold on average
constexpr const char* overlap_name = "overlap_dz";
constexpr const char* distribution_name = "spatial_distribution";

struct SwathOptions {
  quality::QualityLevel quality_level = quality::QualityLevel::none;
  std::optional<core::Metres> anps;
  core::Metres max_gap{100.0};
  bool shores = true;
  std::optional<core::Metres> cell;
  core::Metres roughness{0.10};
  int least = 8;
};

template <class V>
void describe(SwathOptions& o, V& v) {
  v.option("quality_level", o.quality_level, "Level by whose pulse spacing voids and distribution are judged; none: the measured spacing.",
           "USGS");
  v.option("anps", o.anps, core::within(0.02, 20.0), "Pulse spacing that they are judged by, in place of the level's or the measured one.");
  v.option("max_gap", o.max_gap, core::within(0.0, 10000.0),
           "Gaps at the rim of the survey up to this width are voids, wider ones outside.");
  v.option("shores", o.shores, "Voids whose rim is level and below the ground around are water, without class 9 or breaklines.");
  v.option("cell", o.cell, core::within(0.5, 20.0), "Side of the cells in which lines are compared; by default 1, 2, 4 or 8 m by density.");
  v.option("roughness", o.roughness, core::within(0.005, 1.0),
           "Compare a cell where each line's single returns fit a plane within this rms.");
  v.option("least", o.least, core::within(5, 1000), "Least number of single returns of a line in a cell that is compared.");
}

/// The spacing that is known before any point is read; 0: it is measured.
double stated_spacing(const SwathOptions& o) {
  if (o.anps) return o.anps->value;
  return o.quality_level == quality::QualityLevel::none ? 0.0 : quality::limits_of(o.quality_level).spacing;
}

double halo(const SwathOptions& o) {
  const double stated = stated_spacing(o);
  const double rule = stated > 0.0 ? stated : widest_measured;
  return std::max(quality::void_halo(rule), o.shores ? quality::rim_halo(rule) : 0.0);
}

/// What the stage works by, from its options and from the measured density.
struct SwathRule {
  quality::PulseSpacing spacing{};
  std::string from;
  double cell = 2.0;                      ///< m, in which lines are compared
  Box extent{};                           ///< of the first returns and a little more, m
  std::optional<std::string> no_voids{};  ///< why neither voids nor the distribution are judged
};

SwathRule rule_of(const Context& context, const SwathOptions& o) {
  const core::Value density = io::read_value_file(context.made("density.json"));
  const auto number = [&](const char* key) {
    const core::Value* v = density.find(key);
    return v && v->is_number() ? v->as_number() : 0.0;
  };
  SwathRule rule;
  // Of the median cell: where lines overlap here and there their mean is closer than the returns beside a void.
  rule.spacing.actual = number("density_50") > 0.0 ? 1.0 / std::sqrt(number("density_50")) : number("spacing_m");
  if (!(rule.spacing.actual > 0.0)) throw core::Error("no first return is among the points", "quality.swath", "are the points numbered?");
  rule.spacing.rule = stated_spacing(o);
  rule.from = o.anps ? "stated" : rule.spacing.rule > 0.0 ? "quality level" : "measured";
  if (rule.spacing.rule == 0.0) {
    rule.spacing.rule = number("spacing_m");
    if (rule.spacing.rule > widest_measured)
      rule.no_voids = "the first returns lie " + core::format_number(std::round(10.0 * rule.spacing.rule) / 10.0) +
                      " m apart, farther than 3 m: state the spacing to judge by, quality.swath.anps";
  }
  const double in_cell = cells_for_least * o.least;
  rule.extent = Box{number("west"), number("south"), number("east"), number("north")}.grown(number("cell_m"));
  for (rule.cell = 1.0; rule.cell < 8.0 && rule.cell * rule.cell * number("single_density") < in_cell;) rule.cell *= 2.0;
  if (o.cell) rule.cell = o.cell->value;
  return rule;
}

/// The part of a tile that the survey may cover: a small and dense cloud would have millions of empty cells around it.
Box covered_part(const Box& tile, const Box& extent) {
  const Box part{std::max(tile.x0, extent.x0), std::max(tile.y0, extent.y0), std::min(tile.x1, extent.x1), std::min(tile.y1, extent.y1)};
  return part.x1 > part.x0 && part.y1 > part.y0 ? part : Box{tile.x0, tile.y0, tile.x0, tile.y0};
}

/// Cells of each void that lie in the lakes and rivers of terrain.breaklines.
void mark_lines(const terrain::Breaklines* lines, const Box& box, double cell, std::vector<quality::VoidRun>& runs) {
  if (!lines || !lines->any_water(box.x0, box.y0, box.x1, box.y1)) return;
  for (quality::VoidRun& r : runs) {
    std::uint32_t cells = 0;
    for (std::int32_t i = r.i0; i < r.i1; ++i) cells += lines->is_water((i + 0.5) * cell, (r.j + 0.5) * cell);
    r.water = std::max(r.water, cells);
  }
}

/// Cells of each void that a terrain model knows as water without a height.
void mark_water(const Context& context, const Box& box, double cell, std::vector<quality::VoidRun>& runs) {
  if (runs.empty() || !context.grids || !context.grids->has(Product::dtm)) return;
  const In<Product::dtm> terrain{*context.grids};
  const core::Grid model = terrain.over(box.grown(terrain.cell()));
  std::vector<std::uint8_t> has_water(static_cast<size_t>(model.lattice.ny), 0);  // rows, few of which have any
  for (size_t c = 0; c < model.reason.size(); ++c)
    if (model.reason[c] == core::Void::water) has_water[c / static_cast<size_t>(model.lattice.nx)] = 1;
  const auto column_of = [&](std::int32_t i) {
    return static_cast<int>(core::cell_index((i + 0.5) * cell, model.lattice.cell) - model.lattice.i0);
  };
  for (quality::VoidRun& r : runs) {
    const auto row = static_cast<int>(core::cell_index((r.j + 0.5) * cell, model.lattice.cell) - model.lattice.j0);
    if (row < 0 || row >= model.lattice.ny || !has_water[static_cast<size_t>(row)]) continue;
    for (std::int32_t i = r.i0, next = 0; i < r.i1; i = next) {  // by columns of the model, which are many cells wide
      const int column = column_of(i);
      next = static_cast<std::int32_t>(std::ceil(static_cast<double>(column + 1 + model.lattice.i0) * model.lattice.cell / cell - 0.5));
      next = std::clamp(next, i + 1, r.i1);
      while (next > i + 1 && column_of(next - 1) != column) --next;  // rounding
      while (next < r.i1 && column_of(next) == column) ++next;
      if (model.lattice.holds(column, row) && model.reason[model.lattice.at(column, row)] == core::Void::water)
        r.water += static_cast<std::uint32_t>(next - i);
    }
  }
}

void look_at_tile(const TileJob& job, const Context& context, const SwathOptions& o, RunCache& cache) {
  const SwathRule& rule = cache.get([&] { return rule_of(context, o); });
  const quality::LineOptions lines{core::Metres(rule.cell), o.roughness, o.least};
  const quality::OverlapCells overlaps = quality::compare_overlaps(job.block, lattice_in(rule.cell, job.box), lines);
  std::vector<float> seen(overlaps.difference.count.begin(), overlaps.difference.count.end());
  TileRasters{context, overlap_name}.write(
      job.key, overlaps.difference.lattice,
      {{"largest difference of two lines, lower number minus higher", "m", &overlaps.difference.height}, {"lines", "", &seen}});
  const Box covered = covered_part(job.box, rule.extent);
  const core::Lattice squares = lattice_in(2.0 * rule.spacing.rule, covered);
  const quality::EvenSwath even = rule.no_voids ? quality::EvenSwath{core::Grid(squares), {}} : quality::even_cells(job.block, squares);
  std::vector<quality::VoidRun> voids;
  std::vector<quality::RimPiece> rims;
  if (!rule.no_voids) {
    const double cell = quality::void_cell(rule.spacing);
    voids = quality::find_voids(job.block, lattice_in(cell, covered), rule.spacing);
    mark_water(context, covered, cell, voids);
    mark_lines(breaklines_of(context, cache), covered, cell, voids);
    if (o.shores) rims = quality::rims_of(job.block, voids, rule.spacing);
  }
  write_rows(piece_file(job.folder, job.key, "swath"), overlaps.pairs, overlaps.bins, overlaps.lines, overlaps.line_bins, even.lines, voids,
             quality::footprint_of(job.block, job.own, rule.spacing), rims);
  write_grid_tile(job.folder / "dz", job.key, overlaps.difference);
  write_grid_tile(job.folder / "even", job.key, even.hit);
}

/// The tiles between those with points.
std::vector<Box> tiles_without_points(const Context& context, const std::vector<TileKey>& tiles) {
  const std::set<TileKey> there(tiles.begin(), tiles.end());
  TileKey low = tiles[0], high = tiles[0];
  for (const TileKey k : tiles) {
    low = {std::min(low.ix, k.ix), std::min(low.iy, k.iy)};
    high = {std::max(high.ix, k.ix), std::max(high.iy, k.iy)};
  }
  std::vector<Box> out;
  for (int ix = low.ix; ix <= high.ix; ++ix)
    for (int iy = low.iy; iy <= high.iy; ++iy)
      if (!there.contains({ix, iy})) out.push_back(context.box_of({ix, iy}));
  return out;
}

SwathFindings judge_swaths(const MergeJob& job, const Context& context, const SwathOptions& o, RunCache& cache) {
  SwathFindings found;
  if (job.tiles.empty()) return found;
  const SwathRule& rule = cache.get([&] { return rule_of(context, o); });
  quality::OverlapCells overlaps;
  std::vector<quality::EvenCells> even;
  std::vector<quality::VoidRun> voids;
  std::vector<quality::FootprintCell> footprint;
  std::vector<quality::RimPiece> rims;
  for (const TileKey key : job.tiles)
    read_rows(piece_file(job.folder, key, "swath"), overlaps.pairs, overlaps.bins, overlaps.lines, overlaps.line_bins, even, voids,
              footprint, rims);
  TileRasters{context, overlap_name}.finish(job.tiles);
  found.quality_level = core::Choices<quality::QualityLevel>::names[static_cast<size_t>(o.quality_level)];
  found.spacing = rule.spacing;
  found.spacing_from = rule.from;
  found.cell = rule.cell;
  found.set_overlaps(quality::judge_overlaps(overlaps));
  found.no_voids = rule.no_voids;
  if (!rule.no_voids) {
    found.set_even(even);
    found.voids =
        quality::judge_voids(std::move(voids), footprint, tiles_without_points(context, job.tiles), rule.spacing, o.max_gap.value, rims);
  }
  write_swath_files(context, found);
  report::DifferenceMapOptions look;
  look.title = "Largest difference of two lines, lower number minus higher";
  write_picture(context, overlap_name, report::draw(report::difference_map(overview_of(job.folder / "dz", job.tiles, rule.cell), look)));
  write_picture(context, distribution_name,
                distribution_map(overview_of(job.folder / "even", job.tiles, 2.0 * rule.spacing.rule), found.voids));
  return found;
}

/// Overlaps: single returns, sorted. Voids: distances in squares of 1072 cells. Distribution: cells of every line.
TileMemory swath_memory(const SwathOptions& o, const Context& c) {
  double spacing = stated_spacing(o), side = c.tile_side;
  if (!c.made("density.json").empty()) {
    const SwathRule rule = rule_of(c, o);
    spacing = rule.spacing.rule;
    side = std::min(side, std::max(rule.extent.x1 - rule.extent.x0, rule.extent.y1 - rule.extent.y0));
  } else if (spacing == 0.0) {
    spacing = planned_spacing;
  }
  side += 2.0 * halo(o);
  return {48.0, {{"", side / 1072.0, side, 20.0}, {"anps", 2.0 * spacing, side, 30.0}}};
}

}  // namespace

Entry swath_stage() {
  return tile<look_at_tile, judge_swaths>(
      "quality.swath", "Flight lines where they overlap, spatial distribution of first returns, voids apart from water; as USGS has them.",
      {.columns = {.needs = {Column::flags, Column::strip},
                   .reads = {Column::classification, Column::return_number, Column::return_count, Column::sigma_v}},
       .memory = swath_memory,
       .implied = [](const SwathOptions&, bool) -> std::string_view { return "quality.density"; },
       .products =
           [](const SwathOptions&) {
             const std::string dz = overlap_name;
             return std::vector<std::string>{"swath.json", "swath.gpkg", dz,
                                             dz + ".vrt",  dz + ".png",  std::string(distribution_name) + ".png"};
           }});
}

}  // namespace swath::stages
