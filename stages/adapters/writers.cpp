// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.h"
#include "io/geotiff.h"
#include "io/las_writer.h"
#include "io/output_file.h"
#include "io/png.h"
#include "io/value_file.h"
#include "io/vector.h"
#include "io/vrt.h"
#include "report/relief.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/units.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

/// Keeps `folder`/tiles.json, the list of the tiles that make the product, and removes tiles of an earlier run that are no longer in it.
void keep_list(const fs::path& folder, const std::vector<std::string>& files) {
  const fs::path list = folder / "tiles.json";
  if (fs::exists(list)) {
    const core::Value before = io::read_value_file(list);
    if (before.is_array())
      for (const core::Value& file : before.items())
        if (file.is_text() && std::find(files.begin(), files.end(), file.as_text()) == files.end()) {
          std::error_code ignored;
          fs::remove(folder / fs::path(file.as_text()).filename(), ignored);
        }
  }
  core::Value now = core::Value::array();
  for (const std::string& f : files) now.push(f);
  io::write_text_file(list, io::to_json(now));
}

struct LasOptions {
  std::string folder = "points";
  bool compress = true;
  double scale = 0.001;
};

template <class V>
void describe(LasOptions& o, V& v) {
  v.option("folder", o.folder, "Folder of the tiles within the output.");
  v.option("compress", o.compress, "LAZ in place of LAS.");
  v.option("scale", o.scale, core::above_to(0.0, 1.0), "Resolution of coordinates, in units of the CRS.");
}

class LasTiles : public OptionStage<LasOptions> {
 public:
  const Info& info() const override {
    static const Info info{"writers.las",
                           "LAS 1.4 or LAZ tiles with WKT CRS, adjusted standard GPS time and extra bytes.",
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
  double bytes_per_point() const override { return 120.0; }
  void run_tile(const Context& context, TileJob& job) const override {
    io::LasWriteOptions o;
    o.scale = Eigen::Vector3d::Constant(options.scale);
    // Near the data, and the same for every tile: tiles can be joined without rounding again.
    o.offset = Eigen::Vector3d(std::round(context.origin.x() / context.unit), std::round(context.origin.y() / context.unit), 0.0);
    o.crs_wkt = context.crs.wkt1();
    o.threads = 1;
    core::Block block = std::move(job.block);
    job.block = {};
    scale_block(context, block, true);
    io::LasWriter writer(context.output / options.folder / name(context, job.key), o);
    writer.write(block);
    writer.finish();
    job.block = std::move(block);
  }
  void run_merge(const Context& context, MergeJob& job) const override {
    std::vector<std::string> files;
    for (const TileKey key : job.tiles) files.push_back(name(context, key));
    keep_list(context.output / options.folder, files);
    job.findings["tiles"] = files.size();
  }

 private:
  std::string name(const Context& context, TileKey key) const { return context.label(key) + (options.compress ? ".laz" : ".las"); }
};

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

class GridTiles : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "writers.gdal",
        "DTM and DSM as Cloud Optimized GeoTIFF tiles (height; sigma, count and void reason beside it) with a mosaic index (VRT).",
        {Grain::tile, Grain::merge},
        {},
        {},
        {Product::dtm},
        {}};
    return info;
  }
  double bytes_per_point() const override { return 16.0; }
  void run_tile(const Context& context, TileJob& job) const override {
    for (const Product p : surfaces(context)) {
      const core::Lattice own = lattice_in(context.grids->cell(p), job.box);
      const core::Grid grid = in_crs_units(context, context.grids->window(p, own));
      const fs::path folder = context.output / name_of(p);
      io::write_grid(folder / name(context, p, job.key, ""), grid, context.survey.crs, io::height_bands);
      io::GridBands quality = io::quality_bands;
      quality.sigma = !grid.sigma.empty();
      quality.count = !grid.count.empty();
      io::write_grid(folder / name(context, p, job.key, "_quality"), grid, context.survey.crs, quality);
    }
  }
  void run_merge(const Context& context, MergeJob& job) const override {
    for (const Product p : surfaces(context)) {
      const fs::path folder = context.output / name_of(p);
      std::vector<std::string> files;
      for (const char* kind : {"", "_quality"}) {
        std::vector<fs::path> tiles;
        for (const TileKey key : job.tiles) {
          files.push_back(name(context, p, key, kind));
          tiles.push_back(folder / files.back());
        }
        io::write_vrt(context.output / (std::string(name_of(p)) + kind + ".vrt"), tiles);
      }
      keep_list(folder, files);
    }
    job.findings["tiles"] = job.tiles.size();
  }

 private:
  static std::vector<Product> surfaces(const Context& context) {
    std::vector<Product> out{Product::dtm};
    if (context.grids->has(Product::dsm)) out.push_back(Product::dsm);
    return out;
  }
  static std::string name(const Context& context, Product p, TileKey key, const std::string& kind) {
    return std::string(name_of(p)) + "_" + context.label(key) + kind + ".tif";
  }
};

}  // namespace

std::unique_ptr<Stage> make_las_writer() { return std::make_unique<LasTiles>(); }
std::unique_ptr<Stage> make_gdal_writer() { return std::make_unique<GridTiles>(); }

}  // namespace swath::stages
