// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <mutex>
#include <optional>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/las/las_writer.h"
#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "io/vector/vector.h"
#include "report/picture.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/clouds.h"
#include "stages/adapters/cloud/tile_list.h"
#include "stages/adapters/units.h"
#include "stages/drawing_file.h"
#include "stages/surfaces.h"

namespace swath::stages {
enum class WrittenTimes { recorded, adjusted };
}

template <>
struct swath::core::Choices<swath::stages::WrittenTimes> {
  static constexpr std::array<std::string_view, 2> names{"recorded", "adjusted"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

struct LasOptions {
  std::string folder = "points";
  bool compress = true;
  std::optional<double> scale;
  std::optional<int> point_format;
  WrittenTimes times = WrittenTimes::recorded;
};

template <class V>
void describe(LasOptions& o, V& v) {
  v.option("folder", o.folder, "Folder of the tiles within the output.");
  v.option("compress", o.compress, "LAZ in place of LAS.");
  v.option("scale", o.scale, core::above_to(0.0, 1.0),
           "Resolution of coordinates, in units of the CRS; unset: that of the cloud's files, or 0.001.");
  v.option("point_format", o.point_format, core::within(0, 10), "Point format; unset: that of the cloud's files, or 6 (7 with colours).");
  v.option("times", o.times, "Times of clouds: as recorded, or adjusted (adjusted standard GPS time).");
}

struct TileFindings {
  std::uint64_t tiles = 0;
};
template <class V>
void describe(const TileFindings& r, V& v) {
  v.result("tiles", r.tiles, core::plain().in_summary(), "Tiles that were written.");
}

class LasTiles : public OptionStage<LasOptions, NoResults, TileFindings> {
 public:
  const Info& info() const override {
    static const Info info{"writers.las",
                           "LAS or LAZ tiles: points of clouds with every field as recorded, others as LAS 1.4 with extra bytes.",
                           {Grain::tile, Grain::merge},
                           {},
                           {},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override {
    core::ColumnSet all;
    for (int c = 0; c < core::column_count; ++c) all.add(static_cast<Column>(c));
    return all;
  }
  bool is_streamed() const override { return true; }
  double bytes_per_point() const override { return 170.0; }
  std::vector<std::string> products() const override { return {options.folder}; }
  void run_tile(const Context& context, TileJob& job) const override {
    io::LasWriteOptions o;
    o.format = options.point_format;
    o.scale = Eigen::Vector3d::Constant(options.scale.value_or(finest_default));
    o.offset = offset_near(context);
    o.crs_wkt = core::Crs(context.product_crs).wkt1();
    o.times_as_they_are = context.weekless;
    o.guid = context.project;
    o.creation_year = static_cast<std::uint16_t>(context.creation_year);
    o.creation_day = static_cast<std::uint16_t>(context.creation_day);
    o.threads = 1;
    std::optional<io::LasWriter> writer;
    const auto open = [&](bool has_sources) {
      if (has_sources) o.sources = sources(context), o.header = header_;
      writer.emplace(context.output / options.folder / name(context, job.key), o);
    };
    // Fields hang on all of the points, so that these are gone through twice.
    job.stream([&](core::Block& block) {
      if (!writer) open(!block.source.empty());
      writer->look_at(block);
    });
    if (!writer) open(false);
    job.stream([&](core::Block& block) {
      if (o.sources) o.sources->complete(block);
      scale_block(context, block, true);
      writer->write(block);
    });
    if (writer->overlap_lost() > 0)
      job.tally.count("overlap flags that the point format cannot hold (point_format = 6 keeps them)", writer->overlap_lost());
    writer->finish();
  }
  void run_merge(const Context& context, MergeJob& job) const override {
    std::vector<std::string> files;
    for (const TileKey key : job.tiles) files.push_back(name(context, key));
    write_list(context.output / options.folder, files);
    job.findings = core::reported(TileFindings{files.size()});
    if (sources_)
      for (const std::string& what : sources_->left_out()) job.tally.count("not carried from the cloud's files", what);
  }

 private:
  static constexpr double finest_default = 0.001;

  /// Near the data, and the same for every tile: tiles can be joined without rounding again.
  static Eigen::Vector3d offset_near(const Context& context) {
    return {std::round(context.origin.x() / context.unit), std::round(context.origin.y() / context.unit), 0.0};
  }

  /// The files of the run's clouds; sets header_, too. The same for every tile.
  std::shared_ptr<const io::LasSources> sources(const Context& context) const {
    std::call_once(sources_read_, [&] {
      std::vector<io::LasSource> files = cloud_sources(context);
      const bool same_places = std::all_of(files.begin(), files.end(), [](const io::LasSource& s) { return s.same_places; });
      const bool same_steps = std::all_of(files.begin(), files.end(), [&](const io::LasSource& s) {
        return s.header.offset == files[0].header.offset && s.header.scale == files[0].header.scale;
      });
      const bool has_legacy = std::any_of(files.begin(), files.end(), [](const io::LasSource& s) { return s.header.point_format < 6; });
      const bool keeps = keeps_crs(context, files);
      auto all = std::make_shared<const io::LasSources>(std::move(files), options.times == WrittenTimes::recorded);
      const bool to_extended = has_legacy && options.point_format.value_or(all->header(false).point_format) >= 6;
      const bool keep_crs = keeps && !to_extended;
      header_ = all->header(keep_crs);
      if (!all->same_project()) {
        header_.guid = context.project;
        header_.creation_year = static_cast<std::uint16_t>(context.creation_year);
        header_.creation_day = static_cast<std::uint16_t>(context.creation_day);
      }
      if (options.scale || !same_places) header_.scale = Eigen::Vector3d::Constant(options.scale.value_or(finest_default));
      if (options.scale || !same_places || !same_steps) header_.offset = offset_near(context);
      if (options.point_format) header_.point_format = *options.point_format;
      if (!keep_crs) io::add_las_wkt(header_, core::Crs(context.product_crs).wkt1());
      if (!keep_crs || options.point_format) header_.version_minor = 4;
      sources_ = std::move(all);
    });
    return sources_;
  }

  std::string name(const Context& context, TileKey key) const { return context.label(key) + (options.compress ? ".laz" : ".las"); }

  mutable std::once_flag sources_read_;
  mutable std::shared_ptr<const io::LasSources> sources_;
  mutable io::LasHeader header_;
};

class GridTiles : public OptionStage<NoOptions, NoResults, TileFindings> {
 public:
  const Info& info() const override {
    static const Info info{
        "writers.gdal",
        "Every grid of the run (DTM, DSM, canopy, slope, hillshade, intensity, densities) as Cloud Optimized GeoTIFF tiles with "
        "a mosaic index (VRT); sigma, count and void reason beside DTM and DSM.",
        {Grain::tile, Grain::merge},
        {},
        {},
        {Product::dtm},
        {}};
    return info;
  }
  double bytes_per_point() const override { return 0.0; }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tiles of 200 and 260 m, cells of 0.5 m: 108 and 144 bytes per cell, with GDAL's
  // own blocks of 512 x 512. One surface is written at a time.
  std::vector<Raster> rasters(const Context& c) const override {
    Raster largest;
    if (c.grids)
      for (const Surface& s : made(c))
        if (const Raster r{"", c.grids->cell(s.product), c.tile_side, 150.0}; r.total(0.0) > largest.total(0.0)) largest = r;
    return {largest};
  }
  std::vector<std::string> products() const override {
    std::vector<std::string> out;
    for (const Surface& s : surfaces()) {
      for (const char* ending : {"", ".vrt"}) out.push_back(std::string(name_of(s.product)) + ending);
      if (s.has_quality) out.push_back(std::string(name_of(s.product)) + "_quality.vrt");
    }
    return out;
  }
  void run_tile(const Context& context, TileJob& job) const override {
    for (const Surface& s : made(context)) {
      const core::Lattice own = lattice_in(context.grids->cell(s.product), job.box);
      const core::Grid in_metres = context.grids->window(s.product, own);
      const fs::path folder = context.output / name_of(s.product);
      const fs::path file = folder / name(context, s.product, job.key, "");
      if (!s.has_quality) {
        const bool is_height = s.unit == "height";
        const core::Grid grid = is_height ? in_crs_units(context, in_metres) : core::Grid();
        const std::string unit(is_height ? (context.vertical_unit == 1.0 ? "m" : "ft") : s.unit);
        io::write_raster(file, in_crs_units(context, own), {{std::string(s.band), unit, is_height ? &grid.height : &in_metres.height}},
                         context.product_crs, true);
        continue;
      }
      const core::Grid grid = in_crs_units(context, in_metres);
      io::write_grid(file, grid, context.product_crs, io::height_bands);
      io::GridBands quality = io::quality_bands;
      quality.sigma = !grid.sigma.empty();
      quality.count = !grid.count.empty();
      io::write_grid(folder / name(context, s.product, job.key, "_quality"), grid, context.product_crs, quality);
    }
  }
  void run_merge(const Context& context, MergeJob& job) const override {
    size_t done = 0;
    for (const Surface& s : made(context)) {
      const fs::path folder = context.output / name_of(s.product);
      std::vector<std::string> files;
      context.progress(static_cast<double>(done++) / static_cast<double>(surfaces().size()), {});
      for (const char* kind : {"", "_quality"}) {
        if (*kind && !s.has_quality) continue;
        std::vector<fs::path> tiles;
        for (const TileKey key : job.tiles) {
          files.push_back(name(context, s.product, key, kind));
          tiles.push_back(folder / files.back());
        }
        io::write_vrt(context.output / (std::string(name_of(s.product)) + kind + ".vrt"), tiles);
      }
      write_list(folder, files);
    }
    job.findings = core::reported(TileFindings{job.tiles.size()});
  }

 private:
  static std::vector<Surface> made(const Context& context) {
    std::vector<Surface> out;
    for (const Surface& s : surfaces())
      if (context.grids->has(s.product)) out.push_back(s);
    return out;
  }
  static std::string name(const Context& context, Product p, TileKey key, const std::string& kind) {
    return std::string(name_of(p)) + "_" + context.label(key) + kind + ".tif";
  }
};

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

class PictureWriter : public OptionStage<PictureWriteOptions, NoResults, PictureFindings> {
 public:
  const Info& info() const override {
    static const Info info{"writers.picture",
                           "Picture of the terrain: hillshade with contours, as PNG, SVG or PDF.",
                           {Grain::merge},
                           {},
                           {},
                           {Product::dtm},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override { return {options.file}; }
  void run_merge(const Context& context, MergeJob& job) const override {
    const core::Lattice extent = extent_of(context, job.tiles);
    if (extent.size() == 0) return;
    core::Grid grid = overview(context, extent, 2 * options.max_side);
    const double cell = grid.lattice.cell;
    grid = in_crs_units(context, std::move(grid));

    report::PictureOptions o = options;
    if (o.title.empty()) o.title = context.survey.name;
    o.unit = context.crs.unit_name() == "metre" ? "m" : "ft";
    o.height_unit = context.vertical_unit == 1.0 ? "m" : "ft";
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
    job.findings = core::reported(PictureFindings{options.file});
  }
};

}  // namespace

std::unique_ptr<Stage> make_las_writer() { return std::make_unique<LasTiles>(); }
std::unique_ptr<Stage> make_picture_writer() { return std::make_unique<PictureWriter>(); }
std::unique_ptr<Stage> make_gdal_writer() { return std::make_unique<GridTiles>(); }

}  // namespace swath::stages
