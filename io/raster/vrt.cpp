// SPDX-License-Identifier: GPL-3.0-or-later
// GDAL's own builder of mosaics makes the file: a ComplexSource per tile, so that its empty cells never cover another tile's heights. It
// takes tiles of any cells and names of bands, and loses bands' names and units: tiles are compared here, and both are set.
#include "io/raster/vrt.h"

#include <gdal_priv.h>
#include <gdal_utils.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "core/config/units.h"
#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

/// The tile's lattice, once it is sure that the tile fits the first.
core::Lattice fitting(const RasterInfo& first, const RasterInfo& info, double cell, const std::filesystem::path& file) {
  const core::Lattice l = lattice_of(info, file);
  const std::string hint = "tiles of one mosaic share cell, bands and CRS";
  if (std::abs(l.cell - cell) > 1e-9 * cell)
    throw core::Error("the tile's cell is " + core::format_number(l.cell) + ", not " + core::format_number(cell), file, hint);
  if (info.types != first.types || info.names != first.names)
    throw core::Error("the tile's bands are not those of the first tile", file, hint);
  if (info.crs_wkt != first.crs_wkt) throw core::Error("the tile's CRS is not that of the first tile", file, hint);
  return l;
}

}  // namespace

void write_vrt(const std::filesystem::path& file, std::vector<std::filesystem::path> names) {
  if (names.empty()) throw core::Error("a mosaic needs at least one tile", file.string());
  std::sort(names.begin(), names.end());
  const RasterInfo first = read_raster_info(names.front());
  const double cell = first.geotransform[1];
  std::int64_t i0 = std::numeric_limits<std::int64_t>::max(), j0 = i0, i1 = -i0, j1 = -i0;
  std::vector<std::string> texts;
  for (const auto& name : names) {
    const core::Lattice l = fitting(first, read_raster_info(name), cell, name);
    i0 = std::min(i0, l.i0), i1 = std::max(i1, l.i0 + l.nx);
    j0 = std::min(j0, l.j0), j1 = std::max(j1, l.j0 + l.ny);
    texts.push_back(std::filesystem::absolute(name).lexically_normal().string());
  }
  constexpr std::int64_t widest = 2147483647;  // a GDAL raster counts its columns and rows in 32 bits
  if (i1 - i0 > widest || j1 - j0 > widest) throw core::Error("the tiles lie too far apart for one raster", file.string());

  std::vector<const char*> tiles;
  for (const std::string& text : texts) tiles.push_back(text.c_str());
  OutputFile out(std::filesystem::absolute(file).lexically_normal());
  const GdalMessages messages;
  const GdalSetting as_read("OSR_WKT_FORMAT", "WKT2_2019");
  char strict[] = "-strict";
  char* arguments[] = {strict, nullptr};
  const std::unique_ptr<GDALBuildVRTOptions, decltype(&GDALBuildVRTOptionsFree)> options(GDALBuildVRTOptionsNew(arguments, nullptr),
                                                                                         GDALBuildVRTOptionsFree);
  Dataset set(GDALDataset::FromHandle(
      GDALBuildVRT(out.temporary().c_str(), static_cast<int>(tiles.size()), nullptr, tiles.data(), options.get(), nullptr)));
  if (!set) messages.fail("cannot make the mosaic", file);
  if (const Dataset tile = open_raster(names.front()); tile && tile->GetSpatialRef()) set->SetSpatialRef(tile->GetSpatialRef());
  set->SetMetadataItem("AREA_OR_POINT", "Area");
  for (size_t b = 0; b < first.names.size(); ++b) {
    set->GetRasterBand(static_cast<int>(b) + 1)->SetDescription(first.names[b].c_str());
    set->GetRasterBand(static_cast<int>(b) + 1)->SetUnitType(first.units[b].c_str());
  }
  set.reset();
  messages.check_written(file);
  out.commit();
}

}  // namespace swath::io
