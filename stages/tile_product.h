// SPDX-License-Identifier: GPL-3.0-or-later
// A product of one file per tile within the output.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/raster/geotiff.h"
#include "stages/stage.h"

namespace swath::stages {

/// Writes `folder`/tiles.json, the list of the tiles that make the product; delivery removes tiles of an earlier run by it.
void write_list(const std::filesystem::path& folder, const std::vector<std::string>& files);

/// Rasters NAME/NAME_<corner>.tif with their index NAME.vrt; "_quality": others of the same name beside them.
struct TileRasters {
  const Context& context;
  std::string name;

  std::filesystem::path file(TileKey key, const std::string& kind = "") const;
  /// Bands on a lattice in metres.
  void write(TileKey key, const core::Lattice& lattice, const std::vector<io::RasterBand>& bands) const;
  /// The index and the list of what the tiles have written.
  void finish(const std::vector<TileKey>& tiles, const std::vector<std::string>& kinds = {""}) const;
};

}  // namespace swath::stages
