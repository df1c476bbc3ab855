// SPDX-License-Identifier: GPL-3.0-or-later
// GDAL's virtual format (gdal.org/drivers/raster/vrt.html): SRS, GeoTransform, one VRTRasterBand with one ComplexSource per tile.
// ComplexSource, not SimpleSource, so that a tile's empty cells never cover another tile's heights where tiles overlap.
#include "io/raster/vrt.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v).ptr;
  return std::string(text, end);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

struct Tile {
  std::filesystem::path file;
  core::Lattice lattice;
  int block_x = 0, block_y = 0;
};

/// The tile's lattice, once it is sure that the tile fits the first.
core::Lattice fitting(const RasterInfo& first, const RasterInfo& info, double cell, const std::filesystem::path& file) {
  const core::Lattice l = lattice_of(info, file);
  const std::string hint = "tiles of one mosaic share cell, bands and CRS";
  if (std::abs(l.cell - cell) > 1e-9 * cell)
    throw core::Error("the tile's cell is " + number(l.cell) + ", not " + number(cell), file, hint);
  if (info.types != first.types || info.names != first.names)
    throw core::Error("the tile's bands are not those of the first tile", file, hint);
  if (info.crs_wkt != first.crs_wkt) throw core::Error("the tile's CRS is not that of the first tile", file, hint);
  return l;
}

std::string rectangle(const char* name, std::int64_t x, std::int64_t y, int nx, int ny) {
  return std::string("      <") + name + " xOff=\"" + std::to_string(x) + "\" yOff=\"" + std::to_string(y) + "\" xSize=\"" +
         std::to_string(nx) + "\" ySize=\"" + std::to_string(ny) + "\"/>\n";
}

}  // namespace

void write_vrt(const std::filesystem::path& file, std::vector<std::filesystem::path> names) {
  if (names.empty()) throw core::Error("a mosaic needs at least one tile", file.string());
  std::sort(names.begin(), names.end());
  const RasterInfo first = read_raster_info(names.front());
  const double cell = first.geotransform[1];
  std::vector<Tile> tiles;
  for (const auto& name : names) {
    const RasterInfo info = read_raster_info(name);
    tiles.push_back({name, fitting(first, info, cell, name), info.block_x, info.block_y});
  }

  std::int64_t i0 = tiles[0].lattice.i0, j0 = tiles[0].lattice.j0, i1 = i0, j1 = j0;
  for (const Tile& t : tiles) {
    i0 = std::min(i0, t.lattice.i0);
    j0 = std::min(j0, t.lattice.j0);
    i1 = std::max(i1, t.lattice.i0 + t.lattice.nx);
    j1 = std::max(j1, t.lattice.j0 + t.lattice.ny);
  }
  constexpr std::int64_t widest = 2147483647;  // a GDAL raster counts its columns and rows in 32 bits
  if (i1 - i0 > widest || j1 - j0 > widest) throw core::Error("the tiles lie too far apart for one raster", file.string());

  const auto folder = std::filesystem::absolute(file).parent_path().lexically_normal();
  std::string out = "<VRTDataset rasterXSize=\"" + std::to_string(i1 - i0) + "\" rasterYSize=\"" + std::to_string(j1 - j0) + "\">\n";
  if (!first.crs_wkt.empty())
    out += "  <SRS dataAxisToSRSAxisMapping=\"" + crs_facts(first.crs_wkt).axis_mapping + "\">" + escaped(first.crs_wkt) + "</SRS>\n";
  out += "  <GeoTransform>" + number(static_cast<double>(i0) * cell) + ", " + number(cell) + ", 0, " +
         number(static_cast<double>(j1) * cell) + ", 0, " + number(-cell) + "</GeoTransform>\n";
  out += "  <Metadata>\n    <MDI key=\"AREA_OR_POINT\">Area</MDI>\n  </Metadata>\n";
  for (size_t b = 0; b < first.types.size(); ++b) {
    out += "  <VRTRasterBand dataType=\"" + first.types[b] + "\" band=\"" + std::to_string(b + 1) + "\">\n";
    if (!first.names[b].empty()) out += "    <Description>" + escaped(first.names[b]) + "</Description>\n";
    if (!first.units[b].empty()) out += "    <UnitType>" + escaped(first.units[b]) + "</UnitType>\n";
    if (first.nodata[b]) out += "    <NoDataValue>" + number(*first.nodata[b]) + "</NoDataValue>\n";
    for (const Tile& t : tiles) {
      const auto relative = std::filesystem::absolute(t.file).lexically_normal().lexically_relative(folder);
      out += "    <ComplexSource>\n      <SourceFilename relativeToVRT=\"1\">" + escaped(relative.generic_string()) + "</SourceFilename>\n";
      out += "      <SourceBand>" + std::to_string(b + 1) + "</SourceBand>\n";
      // With its size known, a reader need not open a tile before it needs the tile's values.
      out += "      <SourceProperties RasterXSize=\"" + std::to_string(t.lattice.nx) + "\" RasterYSize=\"" + std::to_string(t.lattice.ny) +
             "\" DataType=\"" + first.types[b] + "\" BlockXSize=\"" + std::to_string(t.block_x) + "\" BlockYSize=\"" +
             std::to_string(t.block_y) + "\"/>\n";
      out += rectangle("SrcRect", 0, 0, t.lattice.nx, t.lattice.ny);
      out += rectangle("DstRect", t.lattice.i0 - i0, j1 - t.lattice.j0 - t.lattice.ny, t.lattice.nx, t.lattice.ny);
      if (first.nodata[b]) out += "      <NODATA>" + number(*first.nodata[b]) + "</NODATA>\n";
      out += "    </ComplexSource>\n";
    }
    out += "  </VRTRasterBand>\n";
  }
  out += "</VRTDataset>\n";
  write_text_file(file, out);
}

}  // namespace swath::io
