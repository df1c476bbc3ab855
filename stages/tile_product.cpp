// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/tile_product.h"

#include "core/grid_units.h"
#include "io/raster/vrt.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::stages {

void write_list(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  core::Value list = core::Value::array();
  for (const std::string& f : files) list.push(f);
  io::write_text_file(folder / "tiles.json", io::to_json(list));
}

std::filesystem::path TileRasters::file(TileKey key, const std::string& kind) const {
  return context.output / name / (name + "_" + context.label(key) + kind + ".tif");
}

void TileRasters::write(TileKey key, const core::Lattice& lattice, const std::vector<io::RasterBand>& bands) const {
  io::write_raster(file(key), core::in_units(context.unit, lattice), bands, context.product_crs, true);
}

void TileRasters::finish(const std::vector<TileKey>& tiles, const std::vector<std::string>& kinds) const {
  std::vector<std::string> names;
  for (const std::string& kind : kinds) {
    std::vector<std::filesystem::path> files;
    for (const TileKey key : tiles) names.push_back(files.emplace_back(file(key, kind)).filename().string());
    io::write_vrt(context.output / (name + kind + ".vrt"), files);
  }
  write_list(context.output / name, names);
}

}  // namespace swath::stages
