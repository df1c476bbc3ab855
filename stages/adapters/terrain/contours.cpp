// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/paste.h"
#include "core/statistics.h"
#include "io/vector/vector.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/terrain/breaklines.h"
#include "stages/adapters/units.h"
#include "stages/segment_file.h"
#include "terrain/contours/contour_labels.h"
#include "terrain/contours/contour_lines.h"
#include "terrain/contours/contour_surface.h"
#include "terrain/contours/contours.h"
#include "terrain/contours/map_class.h"
#include "terrain/contours/spot_heights.h"
#include "terrain/dtm.h"

namespace swath::stages {

/// What is traced: the DTM's cells, or a finer lattice that the TIN is read on.
enum class ContourSource { grid, tin };

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::ContourSource> {
  static constexpr std::array<std::string_view, 2> names{"grid", "tin"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

constexpr size_t page_bytes = size_t{64} << 20, least_page_bytes = size_t{8} << 20;  ///< of the surface, while lines are drawn; of a thread
constexpr size_t drawn_bytes = size_t{256} << 20;                                    ///< of the levels that are drawn at once

/// Of the surface alone: contours have no sigma from assumed ones.
struct TinOptions : terrain::DtmOptions {};
template <class V>
void describe(TinOptions& o, V& v) {
  describe_surface(o, v);
}

struct ContourWriteOptions : terrain::ContourOptions {
  std::string name = "contours";
  ContourSource source = ContourSource::grid;
  TinOptions tin;
  terrain::LabelOptions labels;
  terrain::SpotOptions spots;

  ContourWriteOptions() { tin.cell = core::Metres(0.5); }
};

template <class V>
void describe(ContourWriteOptions& o, V& v) {
  describe(static_cast<terrain::ContourOptions&>(o), v);
  v.option("name", o.name, "Name of the files: NAME.gpkg, NAME.dxf, NAME.geojson.");
  v.option("source", o.source, "grid: the DTM's cells; tin: the TIN of the ground points, read on the lattice of the table `tin`.");
  v.table("tin", o.tin, "With source tin: how the TIN is made and read, as terrain.dtm does.");
  v.table("labels", o.labels, "Heights along index contours.");
  v.table("spots", o.spots, "Spot heights.");
}

/// Decimals that a step of heights needs, at most 3.
int decimals_of(double step) {
  for (int n = 0; n < 3; ++n)
    if (std::abs(step * std::pow(10.0, n) - std::round(step * std::pow(10.0, n))) < 1e-6) return n;
  return 3;
}

std::string height_text(double height, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, height);
  return text;
}

struct ContourCounts {
  std::uint64_t segments = 0;
};
template <class V>
void describe(const ContourCounts& r, V& v) {
  v.result("contour segments", r.segments, "Pieces of lines within cells.");
}

/// What is written, and how it fits the model.
struct ContourFindings {
  std::uint64_t lines = 0, left_out = 0, closed = 0, depressions = 0;
  double metres = 0.0;
  std::uint64_t labels = 0, tops = 0, pits = 0;
  terrain::CarriedInterval interval{};
};

template <class V>
void describe(const ContourFindings& r, V& v) {
  v.result("lines", r.lines, core::plain().in_summary(), "Contour lines.");
  v.result("left_out", r.left_out, core::if_any(), "Lines shorter than min_length or enclosing less than min_area: not written.");
  v.result("closed", r.closed, "Lines that close.");
  v.result("depressions", r.depressions, "Lines around lower ground.");
  v.result("length_m", r.metres, core::metres(0), "Length of all lines.");
  v.result("labels", r.labels, "Heights written along index contours.");
  v.result("tops", r.tops, "Spot heights of tops.");
  v.result("pits", r.pits, "Spot heights of pits.");
  describe(r.interval, v);
}

/// Flying height, m: NaN where the run has no trajectory on the map.
double flying_height(const Context& context, const trajectory::Trajectory* flown) {
  if (!flown || context.crs.empty()) return std::nan("");
  const core::TrajectoryData& d = flown->data();
  const core::Transform to_map(core::wgs84_geodetic(), context.crs);
  const size_t step = std::max<size_t>(1, d.size() / 1000);
  std::vector<double> heights;
  for (size_t k = 0; k < d.size(); k += step)
    heights.push_back(to_map({core::to_degrees(d.longitude[k]), core::to_degrees(d.latitude[k]), d.height[k]}).z() *
                      metres_per_transformed_height(context));
  return core::median(std::move(heights));
}

// 0.1 um of rounding hides the last bits of the conversion to feet.
double rounded(double height) { return std::round(height * 1e7) / 1e7; }

core::ContourLine in_crs_units(const Context& context, const terrain::ContourLine& line) {
  core::ContourLine out;
  for (const auto& v : line.vertices) {
    out.x.push_back(v.x() / context.unit);
    out.y.push_back(v.y() / context.unit);
  }
  out.height = rounded(line.height / context.vertical_unit);
  out.index = line.is_index;
  out.closed = line.closed;
  out.depression = line.depression;
  return out;
}
/// Cells around a tile that its lines and spot heights depend on: squares reach a cell beyond the tile.
int border(const ContourWriteOptions& o, double cell) {
  return std::max(1 + terrain::contour_surface_reach(terrain::vertical_tolerance(o)),
                  1 + static_cast<int>(std::ceil(terrain::halo(o.spots) / cell)));
}

double halo(const ContourWriteOptions& o) {
  const double cell = o.tin.cell.value;
  return o.source == ContourSource::grid ? 0.0 : terrain::halo(o.tin) + border(o, cell) * cell;
}

/// The stage's options in a run.
struct ContourRun {
  const Context& context;
  const ContourWriteOptions& options;

  double interval() const { return options.interval ? options.interval->value : terrain::usual_interval_of(context.vertical_unit); }
  terrain::ContourOptions spaced() const {
    terrain::ContourOptions o = options;
    o.interval = core::Metres(interval());
    return o;
  }
  double cell() const { return options.source == ContourSource::grid ? context.grids->cell(Product::dtm) : options.tin.cell.value; }

  /// The model that is contoured, of any window.
  core::Grid surface(const fs::path& folder, const core::Lattice& window) const {
    if (options.source == ContourSource::grid) return context.grids->window(Product::dtm, window);
    core::Grid out(window);
    const auto tile = [&](double edge) { return static_cast<int>(std::floor(edge / context.tile_side)); };
    for (int iy = tile(window.south()); iy <= tile(window.north()); ++iy)
      for (int ix = tile(window.west()); ix <= tile(window.east()); ++ix)
        if (const fs::path file = grid_file(folder, {ix, iy}); fs::exists(file)) core::paste(io::read_grid_file(file), out);
    return out;
  }

  void write_lines(const MergeJob& job, io::ContourFiles& files, ContourFindings& found) const {
    std::map<std::int64_t, std::vector<LevelSegments>> levels;
    for (const TileKey key : job.tiles) add_levels(job.folder, key, levels);
    const auto share = static_cast<size_t>(context.memory / 8.0);  // a byte of segments takes eight until it is written
    tbb::enumerable_thread_specific<terrain::Facets> surfaces([&] {
      return terrain::Facets(
          cell(), [&](const core::Lattice& window) { return surface(job.folder, window); },
          std::max(least_page_bytes, std::min(page_bytes, share) / static_cast<size_t>(context.threads)));
    });
    terrain::Labeller labeller(options.labels);
    const int decimals = std::max(decimals_of(interval() / context.vertical_unit), decimals_of(options.base.value / context.vertical_unit));
    // Levels do not know of one another: several are drawn at once, as many as their bytes allow, and written in their order.
    std::vector<size_t> bytes;
    for (const auto& [level, stretches] : levels) {
      bytes.push_back(0);
      for (const LevelSegments& s : stretches) bytes.back() += s.bytes();
    }
    std::sort(bytes.begin(), bytes.end(), std::greater<>());
    size_t at_once = 0;
    for (size_t sum = 0; at_once < std::min(bytes.size(), 2 * static_cast<size_t>(context.threads)); ++at_once)
      if ((sum += bytes[at_once]) > std::min(drawn_bytes, share)) break;
    at_once = std::max<size_t>(at_once, 1);
    using Segments = std::shared_ptr<std::vector<terrain::Segment>>;
    using Lines = std::shared_ptr<terrain::DrawnLines>;
    auto level = levels.begin();
    const auto read = [&](tbb::flow_control& flow) -> Segments {
      if (level == levels.end()) {
        flow.stop();
        return nullptr;
      }
      auto segments = std::make_shared<std::vector<terrain::Segment>>();
      for (const LevelSegments& s : (level++)->second) read_segments(s, *segments);
      return segments;
    };
    const terrain::ContourOptions drawn = spaced();
    const auto draw = [&](const Segments& segments) -> Lines {
      return std::make_shared<terrain::DrawnLines>(terrain::contour_lines(std::move(*segments), drawn, surfaces.local()));
    };
    size_t finished = 0;
    const auto write = [&](const Lines& lines) {
      context.progress(static_cast<double>(++finished) / static_cast<double>(bytes.size()), {});
      found.left_out += lines->left_out;
      for (const terrain::ContourLine& line : lines->lines) {
        found.metres += terrain::length(line.vertices);
        found.closed += line.closed ? 1 : 0;
        found.depressions += line.depression ? 1 : 0;
        const core::ContourLine out = in_crs_units(context, line);
        files.add(out);
        if (!line.is_index) continue;
        const std::string text = height_text(out.height, decimals);
        for (const terrain::ContourLabel& label : labeller.add(line, text.size())) {
          ++found.labels;
          const core::ContourLabel written{label.at.x() / context.unit,
                                           label.at.y() / context.unit,
                                           text,
                                           label.angle,
                                           options.labels.height.value / context.unit,
                                           out.height};
          files.add(written);
        }
      }
    };
    tbb::parallel_pipeline(at_once, tbb::make_filter<void, Segments>(tbb::filter_mode::serial_in_order, read) &
                                        tbb::make_filter<Segments, Lines>(tbb::filter_mode::parallel, draw) &
                                        tbb::make_filter<Lines, void>(tbb::filter_mode::serial_in_order, write));
    found.lines = files.count();
  }

  void write_spots(std::vector<terrain::SpotHeight> spots, io::ContourFiles& files, ContourFindings& found) const {
    std::sort(spots.begin(), spots.end());
    const int decimals = std::min(3, decimals_of(interval() / context.vertical_unit) + 1);
    for (const terrain::SpotHeight& s : spots) {
      core::SpotHeight out;
      out.x = (static_cast<double>(s.i) + 0.5) * cell() / context.unit;
      out.y = (static_cast<double>(s.j) + 0.5) * cell() / context.unit;
      out.height = rounded(s.height / context.vertical_unit);
      out.text = height_text(out.height, decimals);
      out.top = s.top != 0;
      out.text_height = options.labels.height.value / context.unit;
      ++(out.top ? found.tops : found.pits);
      files.add(out);
    }
  }
};

/// Of one tile before its lines fill the disk, and of all tiles before they are drawn.
void refuse_too_many_levels(const terrain::SurfaceFacts& facts, double interval, const Context& context) {
  const std::string fault = terrain::too_many_levels(facts, interval, context.vertical_unit);
  if (fault.empty()) return;
  const double least = terrain::least_interval(facts, context.vertical_unit), unit = context.vertical_unit;
  throw core::usage_error(fault, "contours.interval",
                          "state an interval of " + terrain::written_out(least / unit) + (unit == 1.0 ? " m" : " ft") +
                              " or more; maps have 0.25 m to 10 m, and what lies below the model's sigma shows its noise");
}

ContourCounts trace_contours(const TileJob& job, const Context& context, const ContourWriteOptions& o, RunCache& cache) {
  const ContourRun run{context, o};
  core::Lattice own = lattice_in(run.cell(), job.box);
  const int around = border(o, own.cell);
  const core::Lattice window{own.cell, own.i0 - around, own.j0 - around, own.nx + 2 * around, own.ny + 2 * around};
  core::Grid grid;
  if (o.source == ContourSource::grid) {
    grid = context.grids->window(Product::dtm, window);
  } else {  // as terrain.dtm makes it, breaklines and boundaries with it
    const terrain::Breaklines* lines = breaklines_of(context, cache);
    grid = terrain::dtm(job.block, window, o.tin, lines);
    if (lines) lines->cut(grid);
    core::Grid mine(own);
    core::paste(grid, mine);
    write_grid_tile(job.folder, job.key, mine);
  }
  // Cells without a height all around cost as much as others and draw nothing.
  const core::Lattice part = core::known_part(grid);
  if (part != grid.lattice) {
    core::Grid known(part);
    core::paste(grid, known);
    grid = std::move(known);
    own = core::common_part(own, part);
  }
  const terrain::SurfaceFacts facts = terrain::facts_of(grid, own, run.interval());
  refuse_too_many_levels(facts, run.interval(), context);
  write_rows(piece_file(job.folder, job.key, "facts"), std::vector{facts}, terrain::spot_heights(grid, own, o.spots));
  const terrain::ContourOptions drawn = run.spaced();
  const auto segments = terrain::trace(terrain::contour_surface(std::move(grid), terrain::vertical_tolerance(drawn)), own, drawn);
  write_segments(job.folder, job.key, segments);
  return {segments.size()};
}
ContourFindings draw_contours(const MergeJob& job, const Context& context, const trajectory::Trajectory* flown,
                              const ContourWriteOptions& o) {
  const ContourRun run{context, o};
  io::ContourFiles files(context.output, o.name, context.product_crs, context.heights);
  std::vector<terrain::SurfaceFacts> tiles;
  std::vector<terrain::SpotHeight> spots;
  for (const TileKey key : job.tiles) read_rows(piece_file(job.folder, key, "facts"), tiles, spots);
  terrain::SurfaceFacts facts;
  for (const terrain::SurfaceFacts& t : tiles) facts += t;
  refuse_too_many_levels(facts, run.interval(), context);
  ContourFindings found;
  run.write_lines(job, files, found);
  run.write_spots(std::move(spots), files, found);
  found.interval = terrain::judge_interval(facts, run.interval(), flying_height(context, flown), context.vertical_unit);
  if (const std::string left_out = files.close(); !left_out.empty()) found.interval.findings.push_back(left_out);
  return found;
}
// Measured 2026-11-22 with tests/stages/memory_test.cpp, cells of 0.5 m: 32 bytes per cell of the grid and of the TIN's lattice; and six
// fields of five bytes while the surface is smoothed.
TileMemory contour_memory(const ContourWriteOptions& o, const Context& c) {
  if (o.source == ContourSource::grid) {
    TileMemory out{0.0, window_of(c, Product::dtm, 1)};
    if (!out.rasters.empty()) {
      const double cell = out.rasters[0].cell;
      out.rasters.push_back({"", cell, c.tile_side + 2.0 * border(o, cell) * cell, 32.0});
    }
    return out;
  }
  const double cell = o.tin.cell.value, side = c.tile_side + 2.0 * border(o, cell) * cell;
  return {300.0, {{"tin.cell", cell, side, 72.0}, {"tin.cell", cell, side + 2.0 * o.tin.max_edge.value, 8.0}}};
}
core::ColumnSet contour_columns(const ContourWriteOptions& o) {
  if (o.source == ContourSource::grid) return {};
  return {core::Column::classification, core::Column::flags, core::Column::sigma_v, core::Column::sigma_h};
}
std::vector<std::string> contour_files(const ContourWriteOptions& o) { return {o.name + ".gpkg", o.name + ".dxf", o.name + ".geojson"}; }

}  // namespace

Entry contours_stage() {
  return tile<trace_contours, draw_contours>(
      "terrain.contours",
      "Smooth contours of the DTM with index contours, depressions, labels and spot heights, joined across tiles, as GeoPackage, DXF and "
      "GeoJSON.",
      {.needs = {Product::dtm},
       .gives = {Product::contours},
       .reads = contour_columns,
       .memory = contour_memory,
       .products = contour_files});
}

}  // namespace swath::stages
