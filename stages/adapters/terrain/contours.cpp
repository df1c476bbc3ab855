// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "core/config/result_visitors.h"
#include "core/geo/crs.h"
#include "core/paste.h"
#include "core/statistics.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/vector.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/terrain/breaklines.h"
#include "stages/adapters/units.h"
#include "stages/grid_tile.h"
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

fs::path facts_file(const fs::path& folder, TileKey key) {
  return folder / (std::to_string(key.ix) + "_" + std::to_string(key.iy) + ".facts");
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
  std::uint64_t lines = 0, closed = 0, depressions = 0;
  double metres = 0.0;
  std::uint64_t labels = 0, tops = 0, pits = 0;
  terrain::CarriedInterval interval{};
};

template <class V>
void describe(const ContourFindings& r, V& v) {
  v.result("lines", r.lines, core::plain().in_summary(), "Contour lines.");
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
    heights.push_back(to_map({core::to_degrees(d.longitude[k]), core::to_degrees(d.latitude[k]), d.height[k]}).z() * context.vertical_unit);
  return core::median(std::move(heights));
}

class Contours : public OptionStage<ContourWriteOptions, ContourCounts, ContourFindings> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.contours",
                           "Smooth contours of the DTM with index contours, depressions, labels and spot heights, joined across tiles, as "
                           "GeoPackage, DXF and GeoJSON.",
                           {Grain::tile, Grain::merge},
                           {},
                           {},
                           {Product::dtm},
                           {Product::contours},
                           {Product::of<trajectory::Trajectory>()}};
    return info;
  }
  core::ColumnSet also_reads() const override {
    if (options.source == ContourSource::grid) return {};
    return {core::Column::classification, core::Column::flags, core::Column::sigma_v, core::Column::sigma_h};
  }
  double halo() const override {
    return options.source == ContourSource::grid ? 0.0
                                                 : terrain::halo(options.tin) + border(options.tin.cell.value) * options.tin.cell.value;
  }
  double bytes_per_point() const override { return options.source == ContourSource::grid ? 0.0 : 300.0; }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, cells of 0.5 m: 32 bytes per cell of the grid and of the TIN's lattice; and six
  // fields of five bytes while the surface is smoothed.
  std::vector<Raster> rasters(const Context& c) const override {
    if (options.source == ContourSource::grid) {
      std::vector<Raster> out = window_of(c, Product::dtm, 1);
      if (!out.empty()) out.push_back({"", out[0].cell, c.tile_side + 2.0 * border(out[0].cell) * out[0].cell, 32.0});
      return out;
    }
    const double side = c.tile_side + 2.0 * border(options.tin.cell.value) * options.tin.cell.value;
    return {{"tin.cell", options.tin.cell.value, side, 72.0},
            {"tin.cell", options.tin.cell.value, side + 2.0 * options.tin.max_edge.value, 8.0}};
  }
  std::vector<std::string> products() const override { return {options.name + ".gpkg", options.name + ".dxf", options.name + ".geojson"}; }

  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice own = lattice_in(cell(context), job.box);
    const int around = border(own.cell);
    const core::Lattice window{own.cell, own.i0 - around, own.j0 - around, own.nx + 2 * around, own.ny + 2 * around};
    core::Grid grid;
    if (options.source == ContourSource::grid) {
      grid = context.grids->window(Product::dtm, window);
    } else {  // as terrain.dtm makes it, breaklines and boundaries with it
      const terrain::Breaklines* lines = lines_.get(context);
      grid = terrain::dtm(job.block, window, options.tin, lines);
      if (lines) lines->cut(grid);
    }
    if (options.source == ContourSource::tin) {
      core::Grid mine(own);
      core::paste(grid, mine);
      write_grid_tile(job.folder, job.key, mine);
    }
    const terrain::SurfaceFacts facts = terrain::facts_of(grid, own, interval(context));
    const auto spots = terrain::spot_heights(grid, own, options.spots);
    const terrain::ContourOptions drawn = spaced(context);
    const auto segments = terrain::trace(terrain::contour_surface(std::move(grid), terrain::vertical_tolerance(drawn)), own, drawn);
    core::count_results(ContourCounts{segments.size()}, job.tally);
    write_segments(job.folder, job.key, segments);
    std::string bytes(reinterpret_cast<const char*>(&facts), sizeof facts);
    bytes.append(reinterpret_cast<const char*>(spots.data()), spots.size() * sizeof(terrain::SpotHeight));
    io::write_text_file(facts_file(job.folder, job.key), bytes);
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    io::ContourFiles files(context.output, options.name, context.product_crs, context.heights);
    terrain::SurfaceFacts facts;
    std::vector<terrain::SpotHeight> spots;
    for (const TileKey key : job.tiles) read_facts(job.folder, key, facts, spots);
    ContourFindings found;
    write_lines(context, job, files, found);
    write_spots(context, std::move(spots), files, found);
    found.interval = terrain::judge_interval(facts, interval(context), flying_height(context, record<trajectory::Trajectory>(context)),
                                             context.vertical_unit);
    if (const std::string left_out = files.close(); !left_out.empty()) found.interval.findings.push_back(left_out);
    job.findings = core::reported(found);
  }

 private:
  BreaklinesOfRun lines_;  ///< of source = "tin"

  double interval(const Context& context) const {
    return options.interval ? options.interval->value : terrain::usual_interval_of(context.vertical_unit);
  }
  terrain::ContourOptions spaced(const Context& context) const {
    terrain::ContourOptions o = options;
    o.interval = core::Metres(interval(context));
    return o;
  }
  /// Cells around a tile that its lines and spot heights depend on: squares reach a cell beyond the tile.
  int border(double cell) const {
    return std::max(1 + terrain::contour_surface_reach(terrain::vertical_tolerance(options)),
                    1 + static_cast<int>(std::ceil(terrain::halo(options.spots) / cell)));
  }

  double cell(const Context& context) const {
    return options.source == ContourSource::grid ? context.grids->cell(Product::dtm) : options.tin.cell.value;
  }

  static void read_facts(const fs::path& folder, TileKey key, terrain::SurfaceFacts& facts, std::vector<terrain::SpotHeight>& spots) {
    const fs::path file = facts_file(folder, key);
    const std::string bytes = io::read_text_file(file);
    if (bytes.size() < sizeof facts || (bytes.size() - sizeof facts) % sizeof(terrain::SpotHeight) != 0) io::cut_short(file);
    terrain::SurfaceFacts one;
    std::memcpy(&one, bytes.data(), sizeof one);
    facts += one;
    const size_t before = spots.size();
    spots.resize(before + (bytes.size() - sizeof one) / sizeof(terrain::SpotHeight));
    if (spots.size() > before) std::memcpy(spots.data() + before, bytes.data() + sizeof one, bytes.size() - sizeof one);
  }

  /// The model that is contoured, of any window.
  core::Grid surface(const Context& context, const fs::path& folder, const core::Lattice& window) const {
    if (options.source == ContourSource::grid) return context.grids->window(Product::dtm, window);
    core::Grid out(window);
    const auto tile = [&](double edge) { return static_cast<int>(std::floor(edge / context.tile_side)); };
    for (int iy = tile(window.south()); iy <= tile(window.north()); ++iy)
      for (int ix = tile(window.west()); ix <= tile(window.east()); ++ix)
        if (const fs::path file = grid_file(folder, {ix, iy}); fs::exists(file)) core::paste(io::read_grid_file(file), out);
    return out;
  }

  void write_lines(const Context& context, const MergeJob& job, io::ContourFiles& files, ContourFindings& found) const {
    std::map<std::int64_t, std::vector<LevelSegments>> levels;
    for (const TileKey key : job.tiles) add_levels(job.folder, key, levels);
    const auto share = static_cast<size_t>(context.memory / 8.0);  // a byte of segments takes eight until it is written
    tbb::enumerable_thread_specific<terrain::Facets> surfaces([&] {
      return terrain::Facets(
          cell(context), [&](const core::Lattice& window) { return surface(context, job.folder, window); },
          std::max(least_page_bytes, std::min(page_bytes, share) / static_cast<size_t>(context.threads)));
    });
    terrain::Labeller labeller(options.labels);
    const int decimals =
        std::max(decimals_of(interval(context) / context.vertical_unit), decimals_of(options.base.value / context.vertical_unit));
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
    using Lines = std::shared_ptr<std::vector<terrain::ContourLine>>;
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
    const terrain::ContourOptions drawn = spaced(context);
    const auto draw = [&](const Segments& segments) -> Lines {
      return std::make_shared<std::vector<terrain::ContourLine>>(terrain::contour_lines(std::move(*segments), drawn, surfaces.local()));
    };
    size_t finished = 0;
    const auto write = [&](const Lines& lines) {
      context.progress(static_cast<double>(++finished) / static_cast<double>(bytes.size()), {});
      for (const terrain::ContourLine& line : *lines) {
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

  void write_spots(const Context& context, std::vector<terrain::SpotHeight> spots, io::ContourFiles& files, ContourFindings& found) const {
    std::sort(spots.begin(), spots.end());
    const int decimals = std::min(3, decimals_of(interval(context) / context.vertical_unit) + 1);
    for (const terrain::SpotHeight& s : spots) {
      core::SpotHeight out;
      out.x = (static_cast<double>(s.i) + 0.5) * cell(context) / context.unit;
      out.y = (static_cast<double>(s.j) + 0.5) * cell(context) / context.unit;
      out.height = rounded(s.height / context.vertical_unit);
      out.text = height_text(out.height, decimals);
      out.top = s.top != 0;
      out.text_height = options.labels.height.value / context.unit;
      ++(out.top ? found.tops : found.pits);
      files.add(out);
    }
  }

  // 0.1 um of rounding hides the last bits of the conversion to feet.
  static double rounded(double height) { return std::round(height * 1e7) / 1e7; }

  static core::ContourLine in_crs_units(const Context& context, const terrain::ContourLine& line) {
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
};

}  // namespace

std::unique_ptr<Stage> make_contours() { return std::make_unique<Contours>(); }

}  // namespace swath::stages
