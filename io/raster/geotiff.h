// SPDX-License-Identifier: GPL-3.0-or-later
// Grids out as cloud optimised GeoTIFF, and back in from any north-up raster that GDAL reads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/grid.h"
#include "io/raster/impossible_heights.h"

namespace swath::io {

/// Stands for "no value" in every raster written. A number, not NaN: all GIS take it, some (Surfer, older ArcGIS, SAGA) not NaN.
constexpr double raster_nodata = -9999.0;

/// Which columns of a Grid become bands, in this order. Columns that the grid lacks are an error.
struct GridBands {
  bool height = true;   ///< band "height", CRS vertical unit
  bool sigma = false;   ///< band "sigma", standard deviation of the height, CRS vertical unit
  bool count = false;   ///< band "count", points in the cell (exact up to 2^24)
  bool reason = false;  ///< band "void reason": 0 height known, 1 no data, 2 edge too long, 3 water, 4 never seen (core::Void)
};

/// The terrain itself: one band, what every program that reads heights expects (<name>_dtm.tif).
constexpr GridBands height_bands{};
/// What is known of its quality, in a file of its own (<name>_dtm_quality.tif).
constexpr GridBands quality_bands{false, true, true, true};

/// Writes the grid as COG: float32, DEFLATE with the floating-point predictor, tiles of 512, overviews inside (height: averaged;
/// quality: nearest), nodata -9999, AREA_OR_POINT=Area, north up, band names and units, the whole CRS (compound where it has a
/// vertical part). The same grid gives the same bytes, whatever the time and the number of threads. `crs`: WKT, EPSG or PROJ text; empty:
/// none stated. Throws core::Error where it cannot be written whole; nothing half-written stays.
void write_grid(const std::filesystem::path& file, const core::Grid& grid, const std::string& crs, GridBands bands = height_bands);

/// One band of a raster to write, on a lattice as core::Grid.
struct RasterBand {
  std::string name;                            ///< band description
  std::string unit;                            ///< "m", "ft", ...; empty: none
  const std::vector<float>* values = nullptr;  ///< row-major from the south-west; NaN where there is no value
};

/// The same for any columns on a lattice (surface models, point density, ...); `average`: overviews by averaging, otherwise nearest.
void write_raster(const std::filesystem::path& file, const core::Lattice& lattice, const std::vector<RasterBand>& bands,
                  const std::string& crs, bool average);

/// Colours on a lattice, row-major from the south-west, over 16 bits; `is_there`: 0 where a cell has none.
struct ColourBands {
  const std::vector<std::uint16_t>*red = nullptr, *green = nullptr, *blue = nullptr;
  const std::vector<std::uint8_t>* is_there = nullptr;
};

/// Writes an image of the map as COG: bands red, green, blue of `bits` (8 or 16) bits and alpha. Throws core::Error as write_grid().
void write_colours(const std::filesystem::path& file, const core::Lattice& lattice, const ColourBands& colours, int bits,
                   const std::string& crs);

/// One band of a raster as the file holds it.
struct Raster {
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};  ///< GDAL's: x = g0 + col g1 + row g2, y = g3 + col g4 + row g5; corner of a pixel
  int nx = 0, ny = 0;
  int bands = 0;               ///< in the file
  std::vector<double> values;  ///< row-major from the top; scale and offset of the band applied; NaN where there is no value
  std::string name, unit;      ///< of the band; may be empty
  std::string crs_wkt;         ///< WKT2:2019; empty where the file states none
};

/// Pixels of a raster, counted from its upper left one.
struct PixelWindow {
  int column = 0, row = 0, columns = 0, rows = 0;
};

/// Reads one band (from 1) of any raster that GDAL reads, or the part of it that lies within a window. Throws core::Error.
Raster read_raster(const std::filesystem::path& file, int band = 1, const std::optional<PixelWindow>& window = std::nullopt);

/// What stands in a raster's header.
struct RasterInfo {
  std::array<double, 6> geotransform{0, 1, 0, 0, 0, -1};
  int nx = 0, ny = 0;

  std::vector<std::string> names, units, types;  ///< of each band; types as GDAL names them ("Float32")
  std::vector<std::optional<double>> nodata;     ///< of each band
  std::string crs_wkt;
};
RasterInfo read_raster_info(const std::filesystem::path& file);

/// The lattice of a north-up raster. Throws core::Error where its pixels are rotated or not square, or where its corner is not on whole
/// multiples of the cell (farther than 1/1000 of a cell).
core::Lattice lattice_of(const RasterInfo& info, const std::filesystem::path& file);

/// Reads a north-up raster (GeoTIFF, AAIGrid .asc, VRT ...) as a Grid: bands that bear our names, or the first band as height.
/// `window`: a lattice of the same cell; what of it lies outside the file has no data. Throws core::Error as lattice_of, and where the
/// window's cell is another. Heights that cannot be are void; `on_impossible` learns of each, its place in units of the file.
core::Grid read_grid(const std::filesystem::path& file, const std::optional<core::Lattice>& window = std::nullopt,
                     const OnImpossible& on_impossible = {});

/// Memory in which blocks of rasters wait to be written or are kept once read; GDAL's default is 5 % of the machine's.
void limit_raster_cache(std::int64_t bytes);

}  // namespace swath::io
