// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/height_unit.h"
#include "core/time.h"
#include "io/copc/tile_index.h"
#include "io/vector/named_areas.h"
#include "io/vector/vector.h"
#include "report/picture.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/las_product.h"
#include "stages/adapters/units.h"
#include "stages/drawing_file.h"
#include "stages/grid_tile.h"
#include "stages/surfaces.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
enum class TileNames { corner, kilometre, areas };
}

template <>
struct swath::core::Choices<swath::stages::TileNames> {
  static constexpr std::array<std::string_view, 3> names{"corner", "kilometre", "areas"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct LasOptions : PointFields {
  std::string folder = "points";
  bool compress = true;
  bool index = true;
  TileNames names = TileNames::corner;
  std::string prefix;
  std::optional<fs::path> areas;
  std::string areas_field = "name";
};

template <class V>
void describe(LasOptions& o, V& v) {
  v.option("folder", o.folder, "Folder of the tiles within the output.");
  v.option("compress", o.compress, "LAZ in place of LAS.");
  v.option("index", o.index, "Virtual point cloud (index.vpc) and map of the tiles (index.gpkg) beside them.");
  v.option("names", o.names, "Tiles' names: south-west corner, that corner in kilometres, or those of areas around tiles.");
  v.option("prefix", o.prefix, "What the tiles' names begin with.");
  v.option("areas", o.areas, "Polygons, relative to survey.toml, that name the tile whose centre they hold (names = areas).");
  v.option("areas_field", o.areas_field, "Field of the polygons with the name.");
  describe(static_cast<PointFields&>(o), v);
  v.check((o.names == TileNames::areas) == o.areas.has_value(), "areas name a file where names = areas, and only there");
  v.check(o.prefix.find('/') == std::string::npos, "a prefix is not a folder");
}

struct TileFindings {
  std::uint64_t tiles = 0;
};
template <class V>
void describe(const TileFindings& r, V& v) {
  v.result("tiles", r.tiles, core::plain().in_summary(), "Tiles that were written.");
}

constexpr double kilometre = 1000.0;

io::NamedAreas areas_of(const Context& context, const LasOptions& o) {
  return io::NamedAreas(io::resolve(context.survey, *o.areas), o.areas_field, context.product_crs);
}

std::vector<fs::path> area_files(const io::Survey& survey, const LasOptions& o) {
  if (!o.areas) return {};
  return {io::resolve(survey, *o.areas)};
}

/// Whole kilometres, or polygons that can be read.
void check_names(const Context& context, const LasOptions& o) {
  if (o.names == TileNames::kilometre && (context.unit != 1.0 || std::fmod(context.tile_side, kilometre) != 0.0))
    throw core::usage_error("tiles of " + core::format_number(context.tile_side) + " m cannot be named by whole kilometres",
                            "writers.las.names", "choose run.tile = \"1 km\" and a CRS in metres, or names = \"corner\"");
  if (o.names == TileNames::areas) areas_of(context, o);
}

std::string las_name(const Context& context, TileKey key, const LasOptions& o, RunCache& cache) {
  const Box box = context.box_of(key);
  std::string name = context.label(key);
  if (o.names == TileNames::kilometre)
    name = std::to_string(std::llround(box.x0 / kilometre)) + "_" + std::to_string(std::llround(box.y0 / kilometre));
  if (o.names == TileNames::areas) {
    const io::NamedAreas& areas = cache.get([&] { return areas_of(context, o); });
    name = areas.at(0.5 * (box.x0 + box.x1) / context.unit, 0.5 * (box.y0 + box.y1) / context.unit);
  }
  return o.prefix + name + (o.compress ? ".laz" : ".las");
}

fs::path facts_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "points"); }

void write_las(TileJob& job, const Context& context, const LasOptions& options, RunCache& cache) {
  const io::TileFacts facts =
      write_points(job, context, options, cache, context.output / options.folder / las_name(context, job.key, options, cache));
  write_rows(facts_file(job.folder, job.key), std::vector{facts});
}

/// A CRS without a way to WGS84 has no place in a virtual point cloud.
void write_index(const MergeJob& job, const Context& context, const std::vector<std::string>& files, const fs::path& folder,
                 core::Tally& tally) {
  io::TileIndex index{{}, context.product_crs, context.unit, context.vertical_unit, {}};
  std::vector<io::TileFacts> facts;
  for (const TileKey key : job.tiles) read_rows(facts_file(job.folder, key), facts);
  for (size_t i = 0; i < files.size(); ++i) index.tiles.push_back({files[i], facts.at(i)});
  const auto full = std::find_if(facts.begin(), facts.end(), [](const io::TileFacts& f) { return f.points > 0; });
  if (full == facts.end()) return;
  constexpr double day = 86400.0;
  const double new_year = core::unix_of_date(std::to_string(std::max(1970, context.creation_year)) + "-01-01").value_or(0.0);
  index.date = core::utc_text(core::from_unix(new_year + std::max(0, context.creation_day - 1) * day));
  if (context.weekless)  // their dates are not known
    for (io::IndexedTile& t : index.tiles) t.facts.first_time = io::TileFacts::none, t.facts.last_time = -io::TileFacts::none;
  io::write_tile_layer(folder / "index.gpkg", index);
  std::vector<std::string> ignored;
  const io::LasHeader header = io::read_las_header(folder / files[static_cast<size_t>(full - facts.begin())], ignored);
  try {
    io::write_vpc(folder / "index.vpc", index, header);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    tally.count("index.vpc is left out: it is in WGS84", std::string(e.what()));
  }
}

TileFindings list_las(const MergeJob& job, const Context& context, const LasOptions& o, RunCache& cache, core::Tally& tally) {
  std::vector<std::string> files;
  for (const TileKey key : job.tiles) files.push_back(las_name(context, key, o, cache));
  if (std::set<std::string>(files.begin(), files.end()).size() != files.size())
    throw core::Error("two tiles have the same name", o.areas.value_or(fs::path()).string(),
                      "choose areas of one tile each, or run.tile as large as the areas");
  if (o.index) write_index(job, context, files, context.output / o.folder, tally);
  write_list(context.output / o.folder, files);
  count_not_carried(cache, tally);
  return {files.size()};
}

std::vector<Surface> surfaces_made(const Context& context) {
  std::vector<Surface> out;
  for (const Surface& s : surfaces())
    if (context.grids && context.grids->has(s.product)) out.push_back(s);
  return out;
}

void write_surfaces(const TileJob& job, const Context& context) {
  for (const Surface& s : surfaces_made(context)) {
    const core::Grid in_metres = context.grids->window(s.product, lattice_in(context.grids->cell(s.product), job.box));
    const bool is_height = s.unit == "height";
    const core::Grid grid = s.has_quality || is_height ? in_crs_units(context, in_metres) : core::Grid();
    const TileRasters out{context, std::string(name_of(s.product))};
    if (!s.has_quality) {
      const std::string unit = is_height ? core::unit_symbol(context.vertical_unit) : std::string(s.unit);
      out.write(job.key, in_metres.lattice, {{std::string(s.band), unit, is_height ? &grid.height : &in_metres.height}});
      continue;
    }
    io::write_grid(out.file(job.key), grid, context.product_crs, io::height_bands);
    io::GridBands quality = io::quality_bands;
    quality.sigma = !grid.sigma.empty();
    quality.count = !grid.count.empty();
    io::write_grid(out.file(job.key, "_quality"), grid, context.product_crs, quality);
  }
}
TileFindings index_surfaces(const MergeJob& job, const Context& context) {
  size_t done = 0;
  for (const Surface& s : surfaces_made(context)) {
    context.progress(static_cast<double>(done++) / static_cast<double>(surfaces().size()), {});
    const TileRasters out{context, std::string(name_of(s.product))};
    out.finish(job.tiles, s.has_quality ? std::vector<std::string>{"", "_quality"} : std::vector<std::string>{""});
  }
  return {job.tiles.size()};
}
// Measured 2026-11-22 with tests/stages/memory_test.cpp, tiles of 200 and 260 m, cells of 0.5 m: 108 and 144 bytes per cell, with GDAL's
// own blocks of 512 x 512. One surface is written at a time.
TileMemory surface_memory(const NoOptions&, const Context& c) {
  Raster largest;
  for (const Surface& s : surfaces_made(c))
    if (const Raster r{"", c.grids->cell(s.product), c.tile_side, 150.0}; r.total(0.0) > largest.total(0.0)) largest = r;
  return {0.0, {largest}};
}
std::vector<std::string> surface_files(const NoOptions&) {
  std::vector<std::string> out;
  for (const Surface& s : surfaces()) {
    for (const char* ending : {"", ".vrt"}) out.push_back(std::string(name_of(s.product)) + ending);
    if (s.has_quality) out.push_back(std::string(name_of(s.product)) + "_quality.vrt");
  }
  return out;
}

/// The DTM's cells that have a height, as one lattice whose borders do not depend on the tiling; empty where there is none.
core::Lattice extent_of(const Context& context, const std::vector<TileKey>& tiles) {
  const double cell = context.grids->cell(Product::dtm);
  std::int64_t i0 = 0, j0 = 0, i1 = 0, j1 = 0;
  for (const TileKey key : tiles) {
    const core::Grid g = context.grids->window(Product::dtm, lattice_in(cell, context.box_of(key)));
    for (int j = 0; j < g.lattice.ny; ++j)
      for (int i = 0; i < g.lattice.nx; ++i) {
        if (g.reason[g.lattice.at(i, j)] != core::Void::none) continue;
        const std::int64_t gi = g.lattice.i0 + i, gj = g.lattice.j0 + j;
        if (i0 == i1) i0 = gi, i1 = gi + 1, j0 = gj, j1 = gj + 1;
        i0 = std::min(i0, gi);
        i1 = std::max(i1, gi + 1);
        j0 = std::min(j0, gj);
        j1 = std::max(j1, gj + 1);
      }
  }
  return {cell, i0, j0, static_cast<int>(i1 - i0), static_cast<int>(j1 - j0)};
}

/// The DTM over `extent`, averaged to at most `most` cells a side, read in bands of rows so that memory stays bounded.
core::Grid overview(const Context& context, core::Lattice extent, int most) {
  const int factor = std::max(1, (std::max(extent.nx, extent.ny) + most - 1) / most);
  if (factor == 1) return context.grids->window(Product::dtm, extent);
  const core::Lattice whole{extent.cell * factor, 0, 0, (extent.nx + factor - 1) / factor, (extent.ny + factor - 1) / factor};
  core::Grid out(whole);
  // Bands as high as a tile, so that no tile is read more than twice.
  const int rows = std::max(1, static_cast<int>(context.tile_side / whole.cell));
  for (int j0 = 0; j0 < whole.ny; j0 += rows) {
    const int n = std::min(rows, whole.ny - j0);
    const core::Grid band = report::averaged(
        context.grids->window(Product::dtm,
                              {extent.cell, extent.i0, extent.j0 + static_cast<std::int64_t>(j0) * factor, whole.nx * factor, n * factor}),
        factor);
    std::copy(band.height.begin(), band.height.end(), out.height.begin() + static_cast<std::ptrdiff_t>(whole.at(0, j0)));
    std::copy(band.reason.begin(), band.reason.end(), out.reason.begin() + static_cast<std::ptrdiff_t>(whole.at(0, j0)));
  }
  return out;
}

struct PictureWriteOptions : report::PictureOptions {
  std::string file = "relief.png";
  std::string contours = "contours.gpkg";
};

template <class V>
void describe(PictureWriteOptions& o, V& v) {
  v.option("file", o.file, "Name of the picture within the output: .png, .svg or .pdf.");
  v.option("contours", o.contours, "The run's contours to draw over it; empty for none.");
  describe(static_cast<report::PictureOptions&>(o), v);
  v.check(names_drawing(o.file), "file ends in .png, .svg or .pdf");
}

struct PictureFindings {
  std::string file{};
};
template <class V>
void describe(const PictureFindings& r, V& v) {
  v.result("file", r.file, "Name of the picture within the output.");
}

std::optional<PictureFindings> draw_picture(const MergeJob& job, const Context& context, const In<Product::dtm>&,
                                            const PictureWriteOptions& options) {
  const core::Lattice extent = extent_of(context, job.tiles);
  if (extent.size() == 0) return std::nullopt;
  core::Grid grid = overview(context, extent, 2 * options.max_side);
  const double cell = grid.lattice.cell;
  grid = in_crs_units(context, std::move(grid));

  report::PictureOptions o = options;
  if (o.title.empty()) o.title = context.survey.name;
  o.unit = core::unit_symbol(context.unit);
  o.height_unit = core::unit_symbol(context.vertical_unit);
  o.light.exaggeration *= context.vertical_unit / context.unit;
  std::vector<core::ContourLine> lines;
  if (const fs::path contours = context.made(options.contours); !options.contours.empty() && !contours.empty()) {
    // The overview has its own corner where it was averaged: contours are moved along.
    const bool moved = cell != extent.cell;
    const double x0 = moved ? extent.west() / context.unit : 0.0, y0 = moved ? extent.south() / context.unit : 0.0;
    for (io::VectorLine& line : io::read_lines(contours).lines) {
      for (double& x : line.x) x -= x0;
      for (double& y : line.y) y -= y0;
      lines.push_back({std::move(line.x), std::move(line.y), line.height, line.index, line.closed});
    }
  }
  write_drawing(context.output / options.file, report::relief_map(grid, lines, o));
  return PictureFindings{options.file};
}

}  // namespace

Entry las_writer_stage() {
  return tile<write_las, list_las>("writers.las",
                                   "LAS or LAZ tiles: points of clouds with every field as recorded, others as LAS 1.4 with extra bytes.",
                                   {.columns = {.needs = {}, .reads = all_columns()},
                                    .memory = [](const LasOptions&, const Context&) { return TileMemory{170.0}; },
                                    .check = check_names,
                                    .files = area_files,
                                    .products = [](const LasOptions& o) { return std::vector{o.folder}; },
                                    .is_streamed = true});
}
Entry gdal_writer_stage() {
  return tile<write_surfaces, index_surfaces>("writers.gdal",
                                              "Every grid of the run (DTM, DSM, canopy, slope, hillshade, intensity, densities) as Cloud "
                                              "Optimized GeoTIFF tiles with a mosaic index "
                                              "(VRT); sigma, count and void reason beside DTM and DSM.",
                                              {.needs = {Product::dtm}, .memory = surface_memory, .products = surface_files});
}
Entry picture_writer_stage() {
  return merge<draw_picture>("writers.picture", "Picture of the terrain: hillshade with contours, as PNG, SVG or PDF.",
                             {.products = [](const PictureWriteOptions& o) { return std::vector{o.file}; }});
}

}  // namespace swath::stages
