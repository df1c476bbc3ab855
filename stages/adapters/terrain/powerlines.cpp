// SPDX-License-Identifier: GPL-3.0-or-later
// Power lines: each tile leaves its returns of wires and towers, and those of ground, vegetation and buildings around wires; the merge
// finds spans and conductors among all wires of the survey, and looks at what is around them span by span.
#include "stages/adapters/terrain/powerlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/block.h"
#include "io/vector/feature_file.h"
#include "stages/adapters/terrain/powerline_files.h"
#include "stages/drawing_file.h"
#include "stages/tile.h"
#include "stages/tile_product.h"
#include "terrain/corridor/bundles.h"

namespace swath::stages {

enum class SheetFormat { none, svg, png, pdf };

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::SheetFormat> {
  static constexpr std::array<std::string_view, 4> names{"none", "svg", "png", "pdf"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
namespace cls = core::point_class;
using core::Column;
using terrain::Hazard;

constexpr std::uint8_t tower_class = 15;                                       // LAS 1.4 R15, table 17: transmission tower
constexpr std::uint8_t key_point_class = 8, rail_class = 10, road_class = 11;  // the same table: ground of delivered clouds, too
constexpr double near_cell = 10.0;                                             // m: cells that say whether a wire is near
constexpr double wire_gaps = 20.0;     // m between returns of one wire, bridged when its surroundings are taken
constexpr double sheet_beside = 20.0;  // m: what a sheet shows

struct PowerLineOptions {
  std::string name = "powerlines";
  std::optional<core::Metres> ground{}, vegetation{}, building{}, wire{};
  core::Radians swing = core::degrees(30.0);
  core::Metres reach{30.0}, min_span{25.0}, tube{0.4};
  SheetFormat sheets = SheetFormat::svg;
};

template <class V>
void describe(PowerLineOptions& o, V& v) {
  v.option("name", o.name, "Name of the files: NAME.gpkg, NAME.dxf, NAME_conductors.csv ..., and of the folder of sheets.");
  v.option("ground", o.ground, core::at_least(0.0), "Smallest distance allowed from a wire to the ground, straight down.");
  v.option("vegetation", o.vegetation, core::at_least(0.0), "Smallest distance allowed from a wire to vegetation.");
  v.option("building", o.building, core::at_least(0.0), "Smallest distance allowed from a wire to a building.");
  v.option("wire", o.wire, core::at_least(0.0), "Smallest distance allowed from a wire to another one.");
  v.option("swing", o.swing, core::within(0.0, 1.4), "Angle by which wind swings a wire to both sides; 0: wires at rest alone.");
  v.option("reach", o.reach, core::within(5.0, 100.0),
           "What is farther from a wire is not looked at; trees at most this high can fall in.");
  v.option("min_span", o.min_span, core::at_least(15.0), "Shorter rows of wire returns are not believed to be a span.");
  v.option("tube", o.tube, core::within(0.1, 1.0), "Returns within this distance of a wire belong to it; holds a bundle together.");
  v.option("sheets", o.sheets, "Format of the sheet drawn of each span.");
  const auto stated = [&](const std::optional<core::Metres>& limit, const std::string& key) {
    v.check(limit.has_value(),
            "the smallest distance allowed must be given: " + key + " = \"6 m\"; it depends on voltage, country and contract");
  };
  stated(o.ground, "ground");
  stated(o.vegetation, "vegetation");
  stated(o.building, "building");
  stated(o.wire, "wire");
}

/// Cells around one with wires whose returns are kept.
std::int64_t cells_around(const PowerLineOptions& o) {
  return static_cast<std::int64_t>(std::ceil((o.reach.value + wire_gaps) / near_cell));
}

/// Whole cells, so that every tile sees the wires of all that are near its own returns.
double halo(const PowerLineOptions& o) { return near_cell * static_cast<double>(cells_around(o) + 1); }

struct PowerLineCounts {
  std::uint64_t wires = 0, towers = 0, around = 0;
};
template <class V>
void describe(const PowerLineCounts& r, V& v) {
  v.result("returns of wires", r.wires, "Returns of class 14.");
  v.result("returns of towers", r.towers, core::if_any(), "Returns of class 15.");
  v.result("returns around wires", r.around, "Returns of ground, water, vegetation and buildings near wires.");
}

/// The smallest distance of all conductors to one kind of obstacle.
struct SmallestClearance {
  std::string to, conductor;
  double at_rest = 0.0, sigma = 0.0, swung = 0.0, limit = 0.0;
  std::uint64_t not_kept = 0;
};
template <class V>
void describe(const SmallestClearance& r, V& v) {
  v.result("to", r.to, "ground, vegetation, building or wire.");
  v.result("conductor", r.conductor, "The conductor with the smallest distance, span.number.");
  v.result("at_rest_m", r.at_rest, core::metres(), "Its distance at rest.");
  v.result("sigma_m", r.sigma, core::metres(), "Standard deviation of that.");
  v.result("swung_m", r.swung, core::metres().in_summary(), "The smallest distance while the wind swings it.");
  v.result("limit_m", r.limit, core::metres(), "The smallest that is allowed.");
  v.result("not_kept", r.not_kept, core::plain().in_summary(), "Conductors that do not keep the limit.");
}

struct PowerLineFindings {
  std::uint64_t spans = 0, whole = 0, conductors = 0, pylons = 0, unused = 0, infringements = 0, trees = 0;
  double metres = 0.0;
  std::vector<SmallestClearance> clearances{};
};
template <class V>
void describe(const PowerLineFindings& r, V& v) {
  v.result("spans", r.spans, core::plain().in_summary(), "Spans found.");
  v.result("whole_spans", r.whole, "Spans with a support at both ends: their wires have a sag.");
  v.result("conductors", r.conductors, core::plain().in_summary(), "Conductors of all spans; a bundle is one.");
  v.result("pylons", r.pylons, core::plain().in_summary(), "Supports.");
  v.result("length_m", r.metres, core::metres(0), "Length of all spans.");
  v.result("unused_wire_returns", r.unused, "Returns of class 14 that belong to no conductor.");
  v.result("infringements", r.infringements, core::plain().in_summary(),
           "Square metres of vegetation and buildings nearer to any wire than their limit.");
  v.result("falling_trees", r.trees, core::plain().in_summary(), "Trees that come too near to a wire when they fall.");
  v.tables("clearances", r.clearances, "Smallest distances by what they are to.");
}

/// A return as a tile leaves it: place minus the run's origin.
struct CorridorRow {
  double x, y, z;
  std::uint32_t line, kind;
};

std::optional<Hazard> hazard_of(std::uint8_t c) {
  if (c == cls::ground || c == cls::water || c == key_point_class || c == rail_class || c == road_class) return Hazard::ground;
  if (c >= cls::low_vegetation && c <= cls::high_vegetation) return Hazard::vegetation;
  if (c == cls::building) return Hazard::building;
  return std::nullopt;
}

fs::path wires_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "wires"); }
fs::path around_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "around"); }

PowerLineCounts collect(const TileJob& job, const PowerLineOptions& o) {
  const core::Block& b = job.block;
  const auto cell = [&](double x, double y) {
    return std::pair{core::cell_index(x + b.origin.x(), near_cell), core::cell_index(y + b.origin.y(), near_cell)};
  };
  std::set<std::pair<std::int64_t, std::int64_t>> with_wires, near;
  for (size_t p = 0; p < b.size(); ++p)
    if (core::is_usable(b, p) && b.classification[p] == cls::wire) with_wires.insert(cell(b.x[p], b.y[p]));
  const std::int64_t ring = cells_around(o);
  for (const auto& [i, j] : with_wires)
    for (std::int64_t v = j - ring; v <= j + ring; ++v)
      for (std::int64_t u = i - ring; u <= i + ring; ++u) near.insert({u, v});
  std::vector<CorridorRow> wires, towers, around;
  for (size_t p = 0; p < job.own; ++p) {
    if (!core::is_usable(b, p)) continue;
    const CorridorRow row{b.x[p], b.y[p], b.z[p], b.strip[p], 0};
    if (b.classification[p] == cls::wire) wires.push_back(row);
    if (b.classification[p] == tower_class) towers.push_back(row);
    const auto kind = hazard_of(b.classification[p]);
    if (!kind || !near.contains(cell(b.x[p], b.y[p]))) continue;
    around.push_back(row);
    around.back().kind = static_cast<std::uint32_t>(*kind);
  }
  write_rows(wires_file(job.folder, job.key), wires, towers);
  write_rows(around_file(job.folder, job.key), around);
  return {wires.size(), towers.size(), around.size()};
}

/// In an order that their places alone decide: sums do not depend on the tiling to the last bit.
template <class Row>
void sort_by_place(std::vector<Row>& rows) {
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
}

/// What lies around a span, from the tiles that it touches. Tiles of the span before are kept.
class Surroundings {
 public:
  Surroundings(const MergeJob& job, const Context& context) : job_(job), context_(context) {}

  std::vector<terrain::Obstacle> of(const terrain::PowerLines& lines, size_t span, double reach) {
    Box box{1e300, 1e300, -1e300, -1e300};
    for (const size_t c : lines.spans[span].conductors)
      for (const double s : {lines.conductors[c].first.s, lines.conductors[c].last.s}) {
        const Eigen::Vector3d p = lines.conductors[c].strand.at(s) + context_.origin;
        box = {std::min(box.x0, p.x() - reach), std::min(box.y0, p.y() - reach), std::max(box.x1, p.x() + reach),
               std::max(box.y1, p.y() + reach)};
      }
    std::map<TileKey, std::vector<CorridorRow>> now;
    std::vector<terrain::Obstacle> out;
    for (const TileKey key : job_.tiles) {
      const Box tile = context_.box_of(key);
      if (tile.x0 > box.x1 || tile.x1 < box.x0 || tile.y0 > box.y1 || tile.y1 < box.y0) continue;
      std::vector<CorridorRow>& rows = now[key];
      if (const auto kept = tiles_.find(key); kept != tiles_.end())
        rows = std::move(kept->second);
      else
        read_rows(around_file(job_.folder, key), rows);
      for (const CorridorRow& r : rows)
        if (box.holds(r.x + context_.origin.x(), r.y + context_.origin.y())) out.push_back({r.x, r.y, r.z, static_cast<Hazard>(r.kind)});
    }
    tiles_ = std::move(now);
    sort_by_place(out);
    return out;
  }

 private:
  const MergeJob& job_;
  const Context& context_;
  std::map<TileKey, std::vector<CorridorRow>> tiles_;
};

terrain::ClearanceOptions clearance_options(const PowerLineOptions& o) {
  terrain::ClearanceOptions c;
  c.reach = o.reach.value, c.swing = o.swing.value;
  c.limit = {o.ground.value().value, o.vegetation.value().value, o.building.value().value, o.wire.value().value};  // by Hazard
  return c;
}

std::string sheet_name(const PowerLineOptions& o, size_t span) {
  char text[40];
  std::snprintf(text, sizeof text, "span_%04zu.", span + 1);
  return text + std::string(core::Choices<SheetFormat>::names[static_cast<size_t>(o.sheets)]);
}

std::string sheet_folder(const PowerLineOptions& o) { return o.name + "_sheets"; }

/// A tree beside a support is seen from the spans on both sides: it is one, with the smaller margin.
class Trees {
 public:
  void add(const std::vector<terrain::FallingTree>& of_a_span) {
    for (const terrain::FallingTree& t : of_a_span) {
      const auto [at, fresh] = number_.try_emplace({t.top.x(), t.top.y(), t.top.z()}, all.size());
      if (fresh)
        all.push_back(t);
      else if (t.margin < all[at->second].margin)
        all[at->second] = t;
    }
  }
  std::vector<terrain::FallingTree> all;

 private:
  std::map<std::array<double, 3>, size_t> number_;  // by their tops
};

void look_around(const MergeJob& job, const Context& context, const PowerLineOptions& o, PowerLineResult& result) {
  const terrain::ClearanceOptions options = clearance_options(o);
  result.clearances.resize(result.lines.conductors.size());
  Surroundings surroundings(job, context);
  const double reach = o.reach.value + 10.0;  // a swung wire reaches farther
  std::vector<std::string> sheets;
  Trees trees;
  for (size_t k = 0; k < result.lines.spans.size(); ++k) {
    const std::vector<terrain::Obstacle> near = surroundings.of(result.lines, k, reach);
    const terrain::Obstacles obstacles(near);
    for (const size_t c : result.lines.spans[k].conductors)
      result.clearances[c] = terrain::clearances_of(result.lines, c, obstacles, options);
    trees.add(terrain::falling_trees(result.lines, k, obstacles, options));
    context.progress(static_cast<double>(k + 1) / static_cast<double>(result.lines.spans.size()), {});
    if (o.sheets == SheetFormat::none) continue;
    sheets.push_back(sheet_name(o, k));
    const report::Chart chart = span_sheet(result, k, near, sheet_beside, context.origin.z());
    write_drawing(context.output / sheet_folder(o) / sheets.back(), report::drawing(chart));
  }
  result.trees = std::move(trees.all);
  if (o.sheets != SheetFormat::none) write_list(context.output / sheet_folder(o), sheets);
}

/// Square metres with an infringement of any conductor, of vegetation and of buildings.
std::uint64_t infringed_area(const PowerLineResult& r) {
  std::set<std::tuple<Hazard, std::int64_t, std::int64_t>> cells;
  for (const terrain::ConductorClearances& c : r.clearances)
    for (const terrain::Infringement& i : c.infringements)
      cells.insert(
          {i.kind, core::cell_index(i.at.x(), terrain::infringement_cell), core::cell_index(i.at.y(), terrain::infringement_cell)});
  return cells.size();
}

PowerLineFindings summary(const PowerLineResult& r, size_t wires) {
  PowerLineFindings found;
  found.spans = r.lines.spans.size();
  for (const terrain::Span& s : r.lines.spans) found.whole += s.is_whole(), found.metres += s.length();
  found.conductors = r.lines.conductors.size();
  found.pylons = r.lines.pylons.size();
  found.unused = wires;
  for (const terrain::Conductor& c : r.lines.conductors) found.unused -= c.strand.points.size();
  found.trees = r.trees.size();
  for (int kind = 0; kind < terrain::hazards; ++kind) {
    SmallestClearance s;
    s.to = terrain::hazard_names[static_cast<size_t>(kind)];
    s.swung = 1e300;
    for (size_t c = 0; c < r.clearances.size(); ++c)
      for (const terrain::Clearance& k : r.clearances[c].smallest) {
        if (static_cast<int>(k.kind) != kind) continue;
        s.not_kept += !k.is_kept();
        if (k.swung >= s.swung) continue;
        s.conductor = conductor_name(r.lines, c);
        s.at_rest = k.at_rest, s.sigma = k.sigma, s.swung = k.swung, s.limit = k.limit;
      }
    if (!s.conductor.empty()) found.clearances.push_back(s);
  }
  found.infringements = infringed_area(r);
  return found;
}

PowerLineFindings find_lines(const MergeJob& job, const Context& context, const PowerLineOptions& o) {
  std::vector<CorridorRow> wire_rows, tower_rows;
  for (const TileKey key : job.tiles) read_rows(wires_file(job.folder, key), wire_rows, tower_rows);
  sort_by_place(wire_rows), sort_by_place(tower_rows);
  std::vector<terrain::WirePoint> wires;
  std::vector<terrain::TowerPoint> towers;
  for (const CorridorRow& r : wire_rows) wires.push_back({r.x, r.y, r.z, static_cast<std::uint16_t>(r.line)});
  for (const CorridorRow& r : tower_rows) towers.push_back({r.x, r.y, r.z});
  terrain::SpanOptions options;
  options.strands.tube = o.tube.value;
  options.least_span = o.min_span.value;
  PowerLineResult result;
  result.lines = terrain::find_power_lines(wires, towers, options);
  for (terrain::Conductor& c : result.lines.conductors) {
    const terrain::Bundle bundle = terrain::bundle_of(wires, c.strand);
    c.wires = bundle.wires, c.spacing = bundle.spacing;
  }
  look_around(job, context, o, result);
  const std::vector<io::SpatialLayer> layers = power_line_layers(result, context);
  io::write_gpkg(context.output / (o.name + ".gpkg"), layers, context.product_crs);
  io::write_dxf(context.output / (o.name + ".dxf"), layers, context.product_crs);
  for (const io::SpatialLayer& layer : layers) io::write_feature_csv(context.output / (o.name + "_" + layer.name + ".csv"), layer);
  return summary(result, wires.size());
}

std::vector<std::string> power_line_files(const PowerLineOptions& o) {
  std::vector<std::string> out{o.name + ".gpkg", o.name + ".dxf"};
  for (const char* layer : {"conductors", "spans", "pylons", "clearances", "infringements", "falling_trees"})
    out.push_back(o.name + "_" + layer + ".csv");
  if (o.sheets != SheetFormat::none) out.push_back(sheet_folder(o));
  return out;
}

}  // namespace

Entry power_lines_stage() {
  return tile<collect, find_lines>(
      "terrain.powerlines",
      "Power lines: conductors as catenaries with sag and sigma, spans, pylons, clearances at rest and swung, trees that can fall in.",
      {.columns = {.needs = {Column::classification, Column::flags, Column::strip}}, .products = power_line_files});
}

}  // namespace swath::stages
