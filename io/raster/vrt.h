// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace swath::io {

/// Writes a mosaic index of raster tiles as GDAL VRT: opens as one raster in every GIS on GDAL and copies no value. Names are relative
/// to the index, so that the folder can be moved. The tiles are raster files on one lattice (io/raster/geotiff.h) with the same bands and
/// the same CRS; where they overlap, the later one in the order of their names wins. The bytes depend on the tiles alone, not on their
/// order. Throws core::Error where tiles do not fit each other or one cannot be read.
void write_vrt(const std::filesystem::path& file, std::vector<std::filesystem::path> tiles);

}  // namespace swath::io
