// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs in any format that GDAL reads, as they are in memory; out as GeoTIFF.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace swath::io {

/// Rows from the top, all bands of a pixel together.
struct ImageRaster {
  int columns = 0, rows = 0, bands = 0;
  int bits = 8;  ///< 8 or 16, of the file
  std::vector<std::uint16_t> values;

  size_t at(int column, int row) const {
    return (static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)) * static_cast<size_t>(bands);
  }
};

/// Throws core::Error, and where a band is neither of bytes nor of unsigned 16-bit numbers, or has a palette: between two numbers of a
/// palette lies no colour.
ImageRaster read_image_raster(const std::filesystem::path& file);

/// Part of a photograph, in pixels from its upper left one.
struct ImageWindow {
  int column = 0, row = 0, columns = 0, rows = 0;
};

/// The part of it within the window, which lies in it. Throws core::Error as read_image_raster().
ImageRaster read_image_window(const std::filesystem::path& file, const ImageWindow& window);

/// Columns, rows, bands and bits, without values. Throws core::Error as read_image_raster().
ImageRaster read_image_facts(const std::filesystem::path& file);

/// Writes a tiled TIFF without loss. Throws core::Error.
void write_image_raster(const std::filesystem::path& file, const ImageRaster& image);

}  // namespace swath::io
