// SPDX-License-Identifier: GPL-3.0-or-later
// The terrain model less a reference, by slope and cover.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "core/relief.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/store/address.h"
#include "io/text/value_file.h"
#include "quality/surface_difference.h"
#include "report/difference_map.h"
#include "report/volumes.h"
#include "stages/adapters/quality/quality_stages.h"
#include "stages/adapters/quality/surface_profiles.h"
#include "stages/map_overview.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

using core::Column;
namespace fs = std::filesystem;

constexpr const char* difference_name = "surface_difference";
constexpr const char* profiles_name = "surface_profiles";

struct SurfaceOptions {
  std::optional<fs::path> reference, profiles;
};

template <class V>
void describe(SurfaceOptions& o, V& v) {
  v.option("reference", o.reference, "Terrain model to compare with, any north-up raster, relative to survey.toml; unset: no comparison.");
  v.option("profiles", o.profiles, "Lines of sections, any vector file, relative to survey.toml; unset: two across the middle.");
  v.check(o.reference || !o.profiles, "profiles need a reference");
}

struct SurfaceCounts {
  std::uint64_t compared = 0, without_reference = 0, impossible = 0;
};

template <class V>
void describe(const SurfaceCounts& r, V& v) {
  v.result("cells compared with the reference", r.compared, core::if_any(), "Cells of the terrain model where both have a height.");
  v.result("cells without a height of the reference", r.without_reference, core::if_any(), "Cells of the terrain model alone.");
  v.result("impossible heights of the reference", r.impossible, core::if_any(), "Pixels that no ground has, on the model; taken as void.");
}

struct SurfaceFindings {
  std::optional<std::string> none{}, heights{}, undeclared{};
  std::string reference{};
  std::optional<double> rms{};
  quality::SurfaceComparison found{};
};

template <class V>
void describe(const SurfaceFindings& r, V& v) {
  v.result("surface", r.none, core::plain().in_summary(), "Why nothing was compared.");
  v.result("reference", r.reference, core::plain().only_if(!r.reference.empty()), "Name of the reference's file.");
  v.result("heights", r.heights, "What is not known of the height systems.");
  v.result("undeclared", r.undeclared, core::plain().in_summary(), "Heights of the reference that no ground has, taken as void.");
  v.result("rms_m", r.rms, core::metres().in_summary().limited_by("surface_difference"), "Terrain model less reference, rms.");
  v.tables("classes", r.found.classes, "Terrain model less reference, by slope and cover.");
  v.result("bins_m", r.found.bins, "Middles of 41 bins of all differences; the outermost hold what lies beyond.");
  v.result("bin_cells", r.found.bin_cells, "Cells in each bin.");
}

fs::path reference_of(const io::Survey& survey, const SurfaceOptions& o) { return io::resolve(survey, *o.reference); }

core::Crs crs_of_reference(const fs::path& file) {
  const std::string wkt = io::read_raster_info(file).crs_wkt;
  return wkt.empty() ? core::Crs() : core::Crs(wkt);
}

/// Refuses a reference on another map or with heights of another system before any point is read.
void check_reference(const io::Survey& survey, const core::Crs& of_survey, const SurfaceOptions& o) {
  if (!o.reference) return;
  const fs::path file = reference_of(survey, o);
  if (!io::is_address(file) && !fs::exists(file))
    throw core::usage_error("no such file", file.string(), "check quality.surface.reference; it is relative to survey.toml");
  if (o.profiles && !fs::exists(io::resolve(survey, *o.profiles)))
    throw core::usage_error("no such file", io::resolve(survey, *o.profiles).string(),
                            "check quality.surface.profiles; it is relative to survey.toml");
  const core::Crs crs = crs_of_reference(file);
  if (crs.empty() || of_survey.empty()) return;
  if (!core::is_same_map(crs, of_survey))
    throw core::usage_error("the reference is in " + crs.name() + ", the survey in " + of_survey.name(), file.string(),
                            "warp it to the survey's CRS first (gdalwarp -t_srs)");
  if (core::are_heights_apart(crs, of_survey))
    throw core::usage_error("the reference's heights are " + crs.vertical_name() + ", the survey's " + of_survey.vertical_name(),
                            file.string(), "bring both to one height system first");
}

/// Cells of the model that were compared, from the first to behind the last; plain data.
struct ComparedCells {
  std::int64_t i0 = std::numeric_limits<std::int64_t>::max(), j0 = i0, i1 = std::numeric_limits<std::int64_t>::lowest(), j1 = i1;
  void add(std::int64_t i, std::int64_t j) {
    i0 = std::min(i0, i), j0 = std::min(j0, j), i1 = std::max(i1, i + 1), j1 = std::max(j1, j + 1);
  }
};

ComparedCells compared_cells(const core::Grid& difference) {
  ComparedCells out;
  const core::Lattice& l = difference.lattice;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      if (difference.reason[l.at(i, j)] == core::Void::none) out.add(l.i0 + i, l.j0 + j);
  return out;
}

SurfaceCounts compare_tile(const TileJob& job, const Context& context, const In<Product::dtm>& terrain, const SurfaceOptions& o,
                           RunCache& cache) {
  if (!o.reference) return {};
  // A cloud's own CRS is known only now.
  cache.get([&] {
    check_reference(context.survey, context.crs, o);
    return true;
  });
  const core::Lattice own = terrain.lattice(job.box);
  const core::Grid around = terrain.window({own.cell, own.i0 - 1, own.j0 - 1, own.nx + 2, own.ny + 2}), model = terrain.window(own);
  io::ImpossibleHeights impossible;  // where the model has a height: whatever the tiling
  const std::optional<io::HeightFile> reference =
      io::find_heights(reference_of(context.survey, o), job.box.grown(2.0 * own.cell), [&](double x, double y, double v) {
        const std::int64_t i = core::cell_index(x, own.cell) - own.i0, j = core::cell_index(y, own.cell) - own.j0;
        if (i >= 0 && j >= 0 && i < own.nx && j < own.ny && !std::isnan(model.height[own.at(static_cast<int>(i), static_cast<int>(j))]))
          impossible.add(v);
      });
  const auto height = [&](double x, double y) {
    return reference && reference->field.knows(x, y) ? reference->field.height(x, y) : std::numeric_limits<double>::quiet_NaN();
  };
  const quality::SurfaceDifference d =
      quality::compare_surface(model, core::slope(around, own), quality::covers_of(job.block, own), height);
  TileRasters{context, difference_name}.write(job.key, own, {{"terrain model less reference", "m", &d.difference.height}});
  write_rows(piece_file(job.folder, job.key, "differences"), d.sums, d.bins, std::vector{compared_cells(d.difference)},
             std::vector{impossible});
  write_grid_tile(job.folder / "map", job.key, d.difference);
  SurfaceCounts counts{0, d.not_compared, impossible.count};
  for (const quality::DifferenceSums& s : d.sums) counts.compared += s.sums.n;
  return counts;
}

/// Around all cells that were compared; of tiles without any nothing counts.
Box box_of(const std::vector<ComparedCells>& of_tiles, double cell) {
  ComparedCells all;
  for (const ComparedCells& c : of_tiles)
    all = {std::min(all.i0, c.i0), std::min(all.j0, c.j0), std::max(all.i1, c.i1), std::max(all.j1, c.j1)};
  return {cell * static_cast<double>(all.i0), cell * static_cast<double>(all.j0), cell * static_cast<double>(all.i1),
          cell * static_cast<double>(all.j1)};
}

/// Sections along the stated lines, or across the middle of what was compared, however it is tiled.
std::vector<SurfaceProfile> profiles_of(const std::vector<ComparedCells>& compared, const Context& context, const SurfaceOptions& o) {
  const double cell = context.grids->cell(Product::dtm);
  const Box box = box_of(compared, cell);
  const HeightsAt model = [&](const std::vector<Eigen::Vector2d>& places, const Box& around) {
    const core::Grid grid = context.grids->window(Product::dtm, core::lattice_of(cell, around.x0, around.y0, around.x1, around.y1));
    std::vector<double> out;
    for (const Eigen::Vector2d& p : places) out.push_back(report::sample(grid, p.x(), p.y()).height);
    return out;
  };
  const HeightsAt reference = [&](const std::vector<Eigen::Vector2d>& places, const Box& around) {
    const std::optional<io::HeightFile> file = io::find_heights(reference_of(context.survey, o), around);
    std::vector<double> out;
    for (const Eigen::Vector2d& p : places)
      out.push_back(file && file->field.knows(p.x(), p.y()) ? file->field.height(p.x(), p.y()) : std::nan(""));
    return out;
  };
  std::vector<SurfaceProfile> out;
  for (const SectionLine& line : o.profiles ? section_lines(context, io::resolve(context.survey, *o.profiles)) : middle_lines(box))
    out.push_back(profile_along(line, cell, model, reference));
  return out;
}

std::optional<std::string> undeclared_in(const std::vector<io::ImpossibleHeights>& of_tiles, const fs::path& reference) {
  io::ImpossibleHeights all;
  for (const io::ImpossibleHeights& one : of_tiles) all.add(one);
  return all.count > 0 ? std::optional(io::sentence_of(all, reference)) : std::nullopt;
}

SurfaceFindings judge_surfaces(const MergeJob& job, const Context& context, const SurfaceOptions& o) {
  SurfaceFindings found;
  if (!o.reference) {
    found.none = "not compared: quality.surface has no reference";
    return found;
  }
  std::vector<quality::DifferenceSums> sums;
  std::vector<quality::DifferenceBin> bins;
  std::vector<ComparedCells> compared;
  std::vector<io::ImpossibleHeights> of_tiles;
  for (const TileKey key : job.tiles) read_rows(piece_file(job.folder, key, "differences"), sums, bins, compared, of_tiles);
  found.undeclared = undeclared_in(of_tiles, *o.reference);
  found.found = quality::judge_surface(sums, bins);
  found.reference = o.reference->filename().string();
  if (found.found.classes.empty())
    throw core::Error("the reference has no height where the survey has terrain", reference_of(context.survey, o).string(),
                      found.undeclared.value_or("is it of this place, and in the survey's CRS?"));
  const core::Crs crs = crs_of_reference(reference_of(context.survey, o));
  if (crs.empty() || crs.heights() == core::Heights::unknown)
    found.heights = "the reference does not state what its heights count from: taken as " + context.heights;
  found.rms = found.found.classes[0].errors.rms;
  core::Value all = core::reported(found);
  core::Value& sections = all["profiles"] = core::Value::array();
  const std::vector<SurfaceProfile> profiles = profiles_of(compared, context, o);
  for (const SurfaceProfile& p : profiles) sections.push(core::reported(p));
  write_profiles(context, profiles_name, profiles);
  TileRasters{context, difference_name}.finish(job.tiles);
  io::write_text_file(context.output / "surface.json", io::to_json(all));
  report::DifferenceMapOptions look;
  look.title = "Terrain model less reference";
  const double cell = context.grids->cell(Product::dtm);
  write_picture(context, difference_name, report::draw(report::difference_map(overview_of(job.folder / "map", job.tiles, cell), look)));
  return found;
}

std::vector<fs::path> files_of_surfaces(const io::Survey& survey, const SurfaceOptions& o) {
  std::vector<fs::path> out;
  if (o.reference) out.push_back(reference_of(survey, o));
  if (o.reference && o.profiles) out.push_back(io::resolve(survey, *o.profiles));
  return out;
}

}  // namespace

Entry surface_stage() {
  return tile<compare_tile, judge_surfaces>(
      "quality.surface", "Terrain model less a reference model by slope and cover, with a map of the differences.",
      {.columns = {.needs = {Column::classification, Column::flags}},
       // Per cell of the model: it twice, slope, difference, counts of returns, the reference with its nodes.
       .memory =
           [](const SurfaceOptions&, const Context& c) {
             return TileMemory{8.0, window_of(c, Product::dtm, 8)};
           },
       .check = [](const Context& c,
                   const SurfaceOptions& o) { check_reference(c.survey, c.survey.crs.empty() ? core::Crs() : core::Crs(c.survey.crs), o); },
       .files = files_of_surfaces,
       .products =
           [](const SurfaceOptions&) {
             const std::string name = difference_name;
             return std::vector<std::string>{"surface.json", name, name + ".vrt", name + ".png", std::string(profiles_name) + ".csv"};
           }});
}

}  // namespace swath::stages
